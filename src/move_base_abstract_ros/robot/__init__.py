"""One robot under move_base's interface: its actions, services, parameters and topics."""
