"""The conformance suite for anybody's driver, by its public name; see `robot_api.conformance`."""

from robot_api.conformance import Problem, Report, Row, check_driver, check_robot

__all__ = ["Problem", "Report", "Row", "check_driver", "check_robot"]
