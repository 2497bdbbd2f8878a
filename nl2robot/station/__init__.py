"""One robot on one port: the server with its services, who may come in, and which robot it is."""
