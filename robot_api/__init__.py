"""The robot as a few simple methods: method table, wire protocol, client, server, drivers."""
