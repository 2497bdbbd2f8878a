"""What stands around a robot's server: who may come in, its port, the calls in flight, its
watchdog."""
