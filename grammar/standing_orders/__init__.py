"""Standing orders: what is to be done each time that something happens."""
