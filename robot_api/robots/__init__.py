"""Robots at an address: `sim`, `ros2://host:9090`, `pepper://host` ..., each with its driver.

    address = parse("ros2://192.168.1.20:9090")
    driver = kind_of(address).connect(Setup(address=address, file=RobotFile(), places=Places()))

`registry` knows the kinds of robots, ours and those of other packages; `robot_file` reads what an
engineer writes down of one robot; `places` is what it is told of the house; `link` tells everybody
whether it can be reached. A folder for each wire holds its driver, put together from
`robot_api.capabilities` like every other.
"""
