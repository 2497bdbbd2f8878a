"""The client for JavaScript in a page of the server, as it is served."""

from __future__ import annotations

from tests.console.conftest import Look


def test_a_page_of_the_server_uses_it_as_it_is(look: Look) -> None:
    said = look("/healthz").evaluate(
        """async () => {
          const {connect} = await import('/static/client/nl2robot.js');
          const ward = await connect();
          const said = [];
          await ward.subscribe('speech', ({text}) => said.push(text));
          await ward.robot.say({text: 'Hello'});
          const wrong = await connect(undefined, {token: 'wrong'}).catch((error) => error.name);
          ward.close();
          return [...said, wrong];
        }"""
    )
    assert said == ["Hello", "AccessDenied"]
