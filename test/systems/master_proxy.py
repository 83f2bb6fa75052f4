"""A ROS master that notes what it is asked, and passes all calls on to the real one."""
import socketserver
import threading
from xmlrpc.client import ServerProxy
from xmlrpc.server import SimpleXMLRPCServer


class MasterProxy(socketserver.ThreadingMixIn, SimpleXMLRPCServer):
    """It listens at ``uri``; ``calls`` has (method, parameters) of each call, in the order in which they came."""

    daemon_threads = True

    def __init__(self, behind):
        """Begin; ``behind``: the URI of the real one."""
        super().__init__(('127.0.0.1', 0), logRequests=False, allow_none=True)
        self.uri = 'http://127.0.0.1:{}/'.format(self.server_address[1])
        self.calls = []
        self._behind = behind
        threading.Thread(target=self.serve_forever, daemon=True).start()

    def close(self):
        """Stop serving."""
        self.shutdown()
        self.server_close()

    def _dispatch(self, method, params):
        for call in params[0] if method == 'system.multicall' else [{'methodName': method, 'params': params}]:
            self.calls.append((call['methodName'], call['params']))
        with ServerProxy(self._behind, allow_none=True) as master:
            return getattr(master, method)(*params)
