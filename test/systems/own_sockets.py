"""The sockets of processes: listening addresses and closed connections."""
import xmlrpc.client

import psutil
import rosgraph


def pid_of(node, master_uri=None):
    """Return the process id of a node; master_uri: its ROS master, by default that of this process."""
    uri = rosgraph.Master('/own_sockets', master_uri=master_uri).lookupNode(node)
    return xmlrpc.client.ServerProxy(uri).getPid('/own_sockets')[2]


def listening_addresses(pid):
    """Return the addresses on which a process listens for TCP connections, as a set of texts."""
    process = psutil.Process(pid)
    connections = getattr(process, 'net_connections', process.connections)(kind='tcp')
    return {one.laddr.ip for one in connections if one.status == psutil.CONN_LISTEN}


def closed_connections(uri):
    """Return the number of connections to a server that clients closed within the last minute."""
    port = int(uri.strip('/').rpartition(':')[2])
    return sum(one.status == psutil.CONN_TIME_WAIT and one.raddr.port == port
               for one in psutil.net_connections(kind='tcp'))
