"""Who holds the button is heard, word by word; whatever goes wrong is told in a sentence.

The bad moments are tried with a wire that answers as it is told to, what is heard with the real
recogniser and a microphone that plays a recording.
"""

from __future__ import annotations

import json
import re
import threading
import wave
from collections.abc import Callable, Iterator
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from nl2robot.cli.operator import Operator
from nl2robot.console.app import STATIC
from nl2robot.console.visitor import LANGUAGES, texts
from nl2robot.speech.audio import RATE, Samples, from_float
from nl2robot.speech.hotword import words as hotword
from nl2robot.speech.speak.voices import joined, voice
from tests.console.conftest import CHROMIUM, FLAGS, SOON, serving
from tests.console.test_thinking import CONSOLE, tell
from tests.console.writing_console import SPOKEN
from tests.fetched import fetched

PAGE = """<!doctype html><html><head><link rel="stylesheet" href="/static/console.css"></head>
<body><script type="module">SCRIPT</script></body></html>"""
SCRIPT = """
import {mountMicrophone} from '/static/microphone.js';
WIRE
document.body.insertAdjacentHTML('afterbegin', `<div class="card row" style="margin: 6rem">
  <button id="talk" class="icon-button"></button> <p id="partial"></p> <ol id="heard"></ol>
  <p id="thought"></p>
  <p id="trouble" role="alert"></p></div>`);
const write = (id, text) => (document.getElementById(id).textContent = text);
window.microphone = mountMicrophone(document.getElementById('talk'), {
  wire, words: WORDS, language: () => 'en', talk: 'a test', ...window.more,
  onPartial: (text) => write('partial', text),
  onHeard: (heard) => document.getElementById('heard').append(
    Object.assign(document.createElement('li'), {textContent: JSON.stringify(heard)})),
  onTrouble: (sentence) => write('trouble', sentence),
  onThinking: (thought) => write('thought', JSON.stringify(thought)),
  onGivenUp: () => write('thought', 'given up'),
});
window.wire = wire;
"""
REAL_WIRE = "import {wire} from '/static/wire.js';"
TOLD_WIRE = """
window.asked = [];
window.answers = {'voice.ready': () => null, 'voice.open': () => 7, 'voice.push': () => [],
  'voice.close': () => [], 'robot.stop': () => null};
window.told = {};
const listeners = [];
const wire = {
  connected: true,
  request: (method, params) => wire.call(method, params).answer,
  call(method, params) {
    return {answer: wire.answer(method, params), cancel: () => asked.push(['cancel', method])};
  },
  subscribe(kind, listener) { told[kind] = listener; return () => delete told[kind]; },
  async answer(method, params) {
    asked.push([method, params]);
    if (!wire.connected) throw Object.assign(new Error('lost'), {kind: 'LostConnection'});
    return answers[method](params);
  },
  onChange(listener) { listeners.push(listener); listener(wire.connected); return () => {}; },
  becomes(connected) { wire.connected = connected; for (const told of listeners) told(connected); },
};
"""
ELSEWHERE = "http://ward.example"
WORDS = texts("microphone", "en")


class Files(SimpleHTTPRequestHandler):
    """The page with the button, and the files of the console."""

    def do_GET(self) -> None:
        if self.path.startswith("/static/"):
            super().do_GET()
            return
        self.send_response(200)
        self.send_header("Content-Type", "text/html; charset=utf-8")
        self.end_headers()
        self.wfile.write(PAGE.replace("SCRIPT", script(TOLD_WIRE)).encode())

    def translate_path(self, path: str) -> str:
        return str(STATIC / path.removeprefix("/static/"))

    def log_message(self, *arguments: Any) -> None: ...


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    """Where the page is: on this machine, so that the browser gives it the microphone."""
    with ThreadingHTTPServer(("127.0.0.1", 0), Files) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}"
        server.shutdown()


@pytest.fixture
def open_page(chromium: Browser, address: str) -> Iterator[Callable[..., Page]]:
    """A page with the button and a wire that answers as it is told."""
    contexts = []

    def open_page(before: str = "", elsewhere: bool = False) -> Page:
        context = chromium.new_context(locale="en")
        context.set_default_timeout(SOON)
        contexts.append(context)
        page = context.new_page()
        page.add_init_script(before)
        if elsewhere:
            page.route(
                f"{ELSEWHERE}/**",
                lambda route: route.fulfill(
                    response=route.fetch(url=route.request.url.replace(ELSEWHERE, address))
                ),
            )
        page.goto(ELSEWHERE if elsewhere else address)
        page.wait_for_function("window.microphone")
        return page

    yield open_page
    for context in contexts:
        context.close()


def script(wire: str) -> str:
    """What makes a button on a page."""
    words = json.dumps(dict(WORDS)).replace("<", "\\u003c")
    return SCRIPT.replace("WORDS", words).replace("WIRE", wire)


def button(page: Page) -> Locator:
    return page.get_by_role("button", name=WORDS["hold"])


def hold(page: Page) -> None:
    """Press the mouse on the button, once it is one, and wait until it listens."""
    expect(button(page)).to_have_attribute("data-state", re.compile("off|ready"), timeout=SOON)
    button(page).hover()
    page.mouse.down()
    becomes(page, "listening")


def becomes(page: Page, state: str) -> None:
    expect(button(page)).to_have_attribute("data-state", state, timeout=SOON)


def trouble(page: Page, key: str) -> None:
    sentence = WORDS[key].split("{")[0]
    expect(page.locator("#trouble")).to_contain_text(sentence, timeout=SOON)


def asked(page: Page, method: str) -> list[Any]:
    return [params for name, params in page.evaluate("asked") if name == method]


def pushed(page: Page, more: int = 6) -> None:
    """Wait until so many more blocks went over the wire; it is held for long enough then."""
    count = "asked.filter(([method]) => method === 'voice.push').length"
    page.wait_for_function(f"{count} >= {page.evaluate(count) + more}")


def answers(page: Page, method: str, function: str) -> None:
    """What the wire answers from now on: a function of JavaScript."""
    page.evaluate("([method, text]) => { answers[method] = eval(text); }", [method, function])


# --- bad moments ---------------------------------------------------------------------------------


def test_every_sentence_is_there_in_every_language() -> None:
    for language in LANGUAGES:
        assert all(texts("microphone", language).values())


def test_the_switch_tells_the_words_that_it_listens_for_in_each_language() -> None:
    for language in LANGUAGES:
        words, heard = texts("microphone", language), hotword.WORDS[language]
        assert heard.hot in words["hands_free_off"]
        assert heard.hot in words["hands_free_on"]
        assert heard.stop[0] in words["hands_free_on"]


def test_from_press_to_release_it_is_one_command(open_page) -> None:
    page = open_page()
    page.evaluate(
        """() => {
          let pushes = 0;
          answers['voice.push'] = () => {
            pushes += 1;
            const partial = {what: 'partial', text: 'go to', stop: false};
            return pushes === 2 ? [{what: 'began'}, partial] : [];
          };
          answers['voice.close'] = () => [{what: 'heard', text: 'go to bed', doubtful: true,
            perhaps: 'goat', stop: false, translation: {program: null}}];
        }"""
    )
    expect(button(page)).to_have_attribute("aria-pressed", "false")
    hold(page)
    expect(button(page)).to_have_attribute("aria-pressed", "true")
    expect(page.locator("#partial")).to_have_text("go to")
    page.wait_for_function(
        "document.getElementById('talk').style.getPropertyValue('--level') > 0"
    )  # the fake microphone beeps
    page.mouse.up()
    expect(page.locator("#heard li")).to_have_count(1)
    heard = json.loads(page.locator("#heard li").inner_text())
    assert (heard["text"], heard["doubtful"], heard["perhaps"]) == ("go to bed", True, "goat")
    becomes(page, "ready")
    [opened] = asked(page, "voice.open")
    about = {"language": "en", "talk": "a test", "interrupts": False, "held": True}
    assert opened == {"rate": 16000, "channels": 1, **about}
    assert all(params["microphone"] == 7 for params in asked(page, "voice.push"))
    assert len(asked(page, "voice.close")) == 1
    expect(page.locator("#trouble")).to_be_empty()


THINKS = """() => {
  answers['voice.close'] = () => new Promise((resolve) => (window.close_with = resolve));
  window.thinks = (what, text) =>
    told.translation({what, text, utterance: 'wheel it in', microphone: 7});
}"""


def test_what_takes_thinking_is_told_meanwhile(open_page) -> None:
    page = open_page()
    page.evaluate(THINKS)
    hold(page)
    pushed(page)
    page.mouse.up()
    page.wait_for_function("!!window.close_with")
    page.evaluate("thinks('thinking')")
    about = {"microphone": 7, "text": "wheel it in"}
    expect(page.locator("#thought")).to_have_text(
        json.dumps({**about, "program": ""}, separators=(",", ":"))
    )
    page.evaluate("thinks('writing', 'robot.goto()')")
    expect(page.locator("#thought")).to_contain_text("robot.goto()")
    page.evaluate("told.translation({what: 'writing', text: 'another', microphone: 8})")
    becomes(page, "thinking")
    page.evaluate(
        "close_with([{what: 'heard', text: 'wheel it in', stop: false, translation: {}}])"
    )
    expect(page.locator("#heard li")).to_have_count(1)
    expect(page.locator("#thought")).to_contain_text("robot.goto()")
    becomes(page, "ready")


def test_who_speaks_anew_ends_the_thinking_about_the_sentence_before(open_page) -> None:
    page = open_page()
    page.evaluate(THINKS)
    hold(page)
    pushed(page)
    page.mouse.up()
    page.wait_for_function("!!window.close_with")
    page.evaluate("thinks('thinking')")
    page.mouse.down()
    becomes(page, "listening")
    expect(page.locator("#thought")).to_have_text("given up")
    assert asked(page, "cancel") == ["voice.close"]
    page.evaluate(
        "close_with([{what: 'heard', text: 'wheel it in', stop: false, translation: {}}])"
    )
    pushed(page)
    page.mouse.up()
    page.wait_for_function("asked.filter(([method]) => method === 'voice.close').length === 2")
    expect(page.locator("#heard li")).to_have_count(0)


def test_a_stop_that_ends_the_thinking_is_no_trouble(open_page) -> None:
    page = open_page()
    page.evaluate(THINKS)
    hold(page)
    pushed(page)
    page.mouse.up()
    page.wait_for_function("!!window.close_with")
    page.evaluate("thinks('thinking')")
    page.evaluate("close_with([{what: 'given up', text: 'wheel it in'}])")
    becomes(page, "ready")
    expect(page.locator("#thought")).to_have_text("given up")
    expect(page.locator("#trouble")).to_be_empty()


def test_the_space_and_enter_keys_hold_it_and_nothing_else_is_pressed(open_page) -> None:
    page = open_page()
    button(page).focus()
    for key in (" ", "Enter"):
        page.keyboard.down(key)
        becomes(page, "listening")
        page.keyboard.down(key)  # repeats, as long as it is held
        pushed(page)
        page.keyboard.up(key)
        trouble(page, "nothing")
        becomes(page, "ready")
    assert len(asked(page, "voice.open")) == 2


def test_who_comes_near_the_button_finds_the_recogniser_ready(open_page) -> None:
    page = open_page()
    button(page).hover()
    button(page).focus()
    assert asked(page, "voice.ready") == [{"language": "en"}]
    becomes(page, "off")
    assert page.evaluate("microphone._sound.open") is False, "nothing listens yet"


def test_a_screen_reader_clicks_once_to_begin_and_once_to_end(open_page) -> None:
    page = open_page()
    page.evaluate("document.getElementById('talk').click()")
    becomes(page, "listening")
    pushed(page)
    page.evaluate("document.getElementById('talk').click()")
    trouble(page, "nothing")


def test_the_sound_right_before_the_press_is_heard_too(open_page) -> None:
    page = open_page()
    hold(page)
    pushed(page)
    page.mouse.up()
    becomes(page, "ready")
    page.wait_for_function("microphone._sound._before.length === 3")
    sent = len(asked(page, "voice.push"))
    answers(page, "voice.open", "() => new Promise((done) => (window.opened = done))")
    hold(page)
    page.evaluate("opened(8)")
    pushed(page, 1)
    first = asked(page, "voice.push")[sent]["sound"]
    assert len(first) * 3 / 4 / 2 >= 3 * 1600, "three tenths of a second in the first push"


def test_the_microphone_is_let_go_of_when_it_is_not_used(open_page) -> None:
    page = open_page(before="window.more = {warm: 50}")
    hold(page)
    pushed(page)
    page.mouse.up()
    trouble(page, "nothing")
    becomes(page, "off")
    assert page.evaluate("microphone._sound.open") is False


def test_who_taps_is_heard_until_they_tap_again(open_page) -> None:
    page = open_page(before="window.performance.now = () => 1e6")
    hold(page)
    page.mouse.up()
    pushed(page)
    becomes(page, "listening")
    expect(button(page)).to_have_attribute("title", re.compile("tap again"))
    assert asked(page, "voice.close") == []
    page.mouse.down()
    page.mouse.up()
    trouble(page, "nothing")
    assert len(asked(page, "voice.close")) == 1, "nothing stays open"


def test_who_tapped_and_says_nothing_more_has_finished(open_page) -> None:
    page = open_page(before="window.performance.now = () => 1e6")
    hold(page)
    page.mouse.up()
    pushed(page)
    page.evaluate("microphone._on({what: 'partial', text: 'go to'}, microphone._utterance)")
    trouble(page, "nothing")
    assert len(asked(page, "voice.close")) == 1


def test_who_lets_go_while_the_browser_asks_is_told_when_it_is_ready(open_page) -> None:
    page = open_page(
        before="""
        const get = navigator.mediaDevices.getUserMedia.bind(navigator.mediaDevices);
        navigator.mediaDevices.getUserMedia = async (what) => {
          await new Promise((allow) => (window.allow = allow));
          return get(what);
        };"""
    )
    button(page).hover()
    page.mouse.down()
    becomes(page, "opening")
    page.evaluate("microphone._pressedAt -= 1000")  # no tap
    page.mouse.up()
    page.evaluate("allow()")
    trouble(page, "now_ready")
    assert asked(page, "voice.open") == []


@pytest.mark.parametrize(
    ("error", "key"),
    [
        ("NotAllowedError", "denied"),
        ("NotFoundError", "no_microphone"),
        ("NotReadableError", "in_use"),
        ("TypeError", "failed"),
    ],
)
def test_why_there_is_no_microphone_is_told(open_page, error, key) -> None:
    page = open_page(
        before=f"navigator.mediaDevices.getUserMedia = () =>"
        f" Promise.reject(new DOMException('no', '{error}'))"
    )
    button(page).hover()
    page.mouse.down()
    trouble(page, key)
    becomes(page, "off")


def test_a_page_that_is_not_secure_has_no_microphone(open_page) -> None:
    page = open_page(elsewhere=True)
    button(page).hover()
    page.mouse.down()
    trouble(page, "not_secure")


def test_a_missing_speech_model_is_told_with_what_to_do(open_page) -> None:
    page = open_page()
    sentence = "The speech model is not installed. Run `nl2robot models get de` to fetch it."
    answers(page, "voice.open", f"() => {{ throw new Error({sentence!r}); }}")
    button(page).hover()
    page.mouse.down()
    expect(page.locator("#trouble")).to_contain_text("nl2robot models get de")
    becomes(page, "ready")


def test_a_lost_connection_is_told_and_the_next_sentence_is_heard(open_page) -> None:
    page = open_page()
    hold(page)
    pushed(page)
    page.evaluate("wire.becomes(false)")
    trouble(page, "lost")
    page.mouse.up()
    page.mouse.down()
    trouble(page, "lost")
    page.mouse.up()
    page.evaluate("wire.becomes(true)")
    page.evaluate("document.getElementById('trouble').textContent = ''")
    hold(page)
    pushed(page)
    page.mouse.up()
    trouble(page, "nothing")


def test_a_server_that_forgot_the_microphone_is_told(open_page) -> None:
    page = open_page()
    answers(page, "voice.push", "() => { throw new Error('It is not open.'); }")
    button(page).hover()
    page.mouse.down()
    trouble(page, "failed")


@pytest.mark.parametrize(
    "cry", [{"what": "stop"}, {"what": "partial", "text": "please stop", "stop": True}]
)
def test_stop_while_it_is_held_stops_the_robot_once(open_page, cry) -> None:
    page = open_page()
    answers(page, "voice.push", f"() => [{json.dumps(cry)}]")
    answers(page, "voice.close", "() => [{what: 'heard', text: 'stop', stop: true}]")
    hold(page)
    pushed(page)  # with a cry in each
    trouble(page, "stopped")
    page.mouse.up()
    becomes(page, "ready")
    assert len(asked(page, "robot.stop")) == 1
    expect(page.locator("#heard li")).to_have_count(0)  # there is nothing left to be reviewed


def test_a_stop_that_does_not_reach_the_robot_is_told(open_page) -> None:
    page = open_page()
    answers(page, "voice.push", "() => [{what: 'stop'}]")
    answers(page, "robot.stop", "() => { throw new Error('lost'); }")
    hold(page)
    trouble(page, "not_stopped")


def test_what_is_held_for_minutes_ends_by_itself(open_page) -> None:
    page = open_page(before="window.more = {longest: 600}")
    hold(page)
    trouble(page, "too_long")
    becomes(page, "ready")
    page.mouse.up()
    assert len(asked(page, "voice.close")) == 1


def test_a_sentence_without_end_is_told(open_page) -> None:
    page = open_page()
    answers(page, "voice.push", "() => [{what: 'too long'}]")
    button(page).hover()
    page.mouse.down()
    trouble(page, "too_long")


def test_leaving_the_page_lets_go_of_the_microphone(open_page) -> None:
    page = open_page()
    hold(page)
    page.evaluate(
        """() => {
          Object.defineProperty(document, 'hidden', {value: true});
          document.dispatchEvent(new Event('visibilitychange'));
        }"""
    )
    trouble(page, "left")
    becomes(page, "off")


def test_escape_takes_back_what_was_said(open_page) -> None:
    page = open_page()
    answers(page, "voice.close", "() => [{what: 'heard', text: 'dance', stop: false}]")
    button(page).focus()
    page.keyboard.down(" ")
    becomes(page, "listening")
    page.keyboard.press("Escape")
    trouble(page, "cancelled")
    page.keyboard.up(" ")
    page.wait_for_function("asked.some(([method]) => method === 'voice.close')")
    expect(page.locator("#heard li")).to_have_count(0)


def test_a_muted_microphone_is_told(open_page) -> None:
    page = open_page(
        before="""
        navigator.mediaDevices.getUserMedia = async () => {
          const context = new AudioContext();
          const quiet = context.createMediaStreamDestination();
          const source = context.createConstantSource();
          source.offset.value = 0;
          source.connect(quiet);
          source.start();
          return quiet.stream;
        };"""
    )
    hold(page)
    pushed(page)
    page.mouse.up()
    trouble(page, "silent")


# --- with the recogniser -------------------------------------------------------------------------


def spoken(text: str) -> Samples:
    sound = joined(voice("en").speak(text))
    return from_float((sound.samples / np.float32(32768))[:, None], sound.rate).samples


@pytest.fixture(scope="module")
def listening(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    """A console with the English speech model."""
    fetched("en")
    home = tmp_path_factory.mktemp("home")
    with serving(home, "--speed", "1", models=True, program=[str(CONSOLE)]) as served:
        yield served


@pytest.fixture
def says(chromium: Browser, listening: Any, tmp_path: Path) -> Iterator[Callable[..., Page]]:
    """A page of that console in a browser whose microphone plays these sentences."""
    browsers = []

    def says(*sentences: str) -> Page:
        quiet = np.zeros(RATE, np.int16)
        sound = np.concatenate(
            [quiet, *(part for each in sentences for part in (spoken(each), quiet))]
        )
        file = tmp_path / "said.wav"
        with wave.open(str(file), "wb") as written:
            written.setparams((1, 2, RATE, 0, "NONE", ""))
            written.writeframes(sound.tobytes())
        browser = chromium.browser_type.launch(
            executable_path=CHROMIUM,
            args=[*FLAGS, f"--use-file-for-fake-audio-capture={file}%noloop"],
        )
        browsers.append(browser)
        page = browser.new_page()
        page.set_default_timeout(SOON)
        page.goto(listening.url)
        expect(page.locator("#connection")).to_have_attribute("data-state", "connected")
        return page

    yield says
    for browser in browsers:
        browser.close()


def with_button(page: Page) -> Page:
    """The page with the button of these tests instead of the desk's."""
    page.locator("#composer").evaluate("form => form.remove()")
    page.add_script_tag(content=script(REAL_WIRE), type="module")
    page.wait_for_function("window.microphone && wire.connected")
    return page


def test_hands_free_the_hot_word_begins_a_command(says) -> None:
    page = says("Hey robot!", "Go to the pharmacy and say hello, please.")
    switch = page.get_by_role("switch", name="Hands free")
    expect(switch).to_have_attribute("aria-checked", "false")
    expect(switch).to_have_attribute("title", re.compile("Switch on"))
    switch.click()
    expect(switch).to_have_attribute("data-state", "listening", timeout=3 * SOON)
    expect(page.locator(".cm-content")).to_contain_text("pharmacy", timeout=3 * SOON)
    expect(page.locator("#microphone")).to_have_attribute("data-state", re.compile("ready|off"))
    expect(switch).to_have_attribute("data-state", "listening")
    switch.click()
    expect(switch).to_have_attribute("aria-checked", "false")
    assert switch.get_attribute("data-state") is None


def test_hands_free_stop_stops_the_robot(says, listening) -> None:
    with listening.robot() as robot:
        stopped = threading.Event()
        robot.subscribe("stopped", lambda kind, data: stopped.set())
        page = says("Stop!")
        switch = page.get_by_role("switch", name="Hands free")
        expect(switch).to_have_attribute("title", re.compile("Switch on"))
        switch.click()
        expect(switch).to_have_attribute("data-state", "listening", timeout=3 * SOON)
        assert stopped.wait(3 * SOON / 1000)
        expect(page.locator("#partial")).to_contain_text("You said stop")


def test_at_the_desk_words_come_while_they_are_said_and_then_the_program(says, picture) -> None:
    page = says("Go to the pharmacy and say hello, please.")
    hold(page)
    expect(page.locator("#partial")).to_contain_text("pharmacy", timeout=SOON)
    picture(page, "microphone-held")
    # The last word of all is told for certain only when one lets go.
    expect(page.locator("#partial")).to_contain_text("hello", timeout=SOON)
    page.mouse.up()
    expect(page.locator(".said.by-you")).to_have_text(
        re.compile("go to the pharmacy"), timeout=SOON
    )
    expect(page.locator(".cm-content")).to_contain_text('robot.goto("pharmacy")')
    expect(page.locator(".cm-content")).to_contain_text('robot.say("Hello!")')
    expect(page.locator("#partial")).to_be_empty()


def test_what_takes_thinking_is_seen_to_grow_and_is_cancelled(says, listening) -> None:
    page = says("Make the people in the lobby happy, please.")
    tell(listening, "hold")
    hold(page)
    expect(page.locator("#partial")).to_contain_text("happy", timeout=SOON)
    page.mouse.up()
    expect(page.locator("#thought")).to_contain_text("robot.goto(")
    expect(page.locator(".said.by-you")).to_have_text(re.compile("make the people"))
    page.get_by_role("button", name="Cancel").click()
    expect(page.locator("#thought")).to_be_hidden()
    expect(page.locator("#words")).to_have_value(SPOKEN)
    tell(listening, "idle")
    becomes(page, "ready")
    page.locator("#words").press("Enter")
    expect(page.locator("#thought")).to_contain_text("robot.goto(")
    tell(listening, "go on")
    expect(page.locator(".by-model")).to_contain_text("Written by a language model")


def test_a_pause_to_think_does_not_end_the_command(says) -> None:
    page = with_button(says("Go to the pharmacy", "and say hello, please."))
    hold(page)
    expect(page.locator("#partial")).to_contain_text("hello", timeout=SOON)
    page.mouse.up()
    expect(page.locator("#heard li")).to_have_count(1, timeout=SOON)
    heard = json.loads(page.locator("#heard li").inner_text())
    assert "robot.goto" in heard["translation"]["program"]
    assert "robot.say" in heard["translation"]["program"]


def test_stop_cried_on_any_page_stops_the_program(says, listening) -> None:
    page = says("Stop!")
    page.goto(f"{listening.url}/map")
    with listening.robot() as robot:
        operator = Operator(robot, "Nurse Kim")
        run = operator.run(operator.approve(operator.check("robot.wait(100)\n")))
        hold(page)
        # Looked for first: it fades.
        expect(page.get_by_role("alert")).to_contain_text(WORDS["stopped"].split("{")[0])
        assert operator.wait(run).state == "stopped"
        expect(button(page)).to_have_attribute("data-state", "listening")  # still held


def test_a_command_said_on_another_page_is_taken_to_the_desk(says, listening) -> None:
    page = says("Go to the pharmacy.")
    page.goto(f"{listening.url}/map")
    hold(page)
    expect(page.get_by_role("alert")).to_contain_text("pharmacy")
    page.mouse.up()
    page.get_by_role("button", name="Open in Talk").click()
    expect(page.locator(".cm-content")).to_have_text('robot.goto("pharmacy")')
