// A robot's wire from Java, with nothing but the JDK (11 or newer):
//
//     java Tour.java ws://127.0.0.1:9090
//     java -Djavax.net.ssl.trustStore=robot.p12 Tour.java wss://robin:9090 TOKEN
//
// It goes to a place, says something, asks, and is told of an error by its name. Ctrl-C stops the robot,
// and so does an error that nobody expected.

import java.net.URI;
import java.net.http.HttpClient;
import java.net.http.WebSocket;
import java.net.http.WebSocketHandshakeException;
import java.util.ArrayList;
import java.util.LinkedHashMap;
import java.util.List;
import java.util.Map;
import java.util.concurrent.CompletableFuture;
import java.util.concurrent.CompletionException;
import java.util.concurrent.CompletionStage;
import java.util.concurrent.ConcurrentHashMap;
import java.util.concurrent.atomic.AtomicLong;
import java.util.stream.Collectors;

public class Tour {
    public static void main(String[] words) {
        String address = words.length > 0 ? words[0] : "ws://127.0.0.1:9090";
        String token = words.length > 1 ? words[1] : null;
        try {
            Robot robot = new Robot(address, token);
            Thread atTheEnd = new Thread(() -> stop(robot));
            Runtime.getRuntime().addShutdownHook(atTheEnd);
            visit(robot);
            Runtime.getRuntime().removeShutdownHook(atTheEnd);
            robot.close();
        } catch (RobotError error) {
            System.err.println(error.name + ": " + error.getMessage());
            System.exit(1); // once the robot stands: after Ctrl-C the hook is at it already
        } catch (IllegalStateException ending) {
            // Ctrl-C came with the last answer.
        }
    }

    private static void visit(Robot robot) {
        robot.listen("speech", event -> System.out.println("It says: " + event.get("text")));
        System.out.println("On the way to ward a.");
        robot.call("robot.goto", Map.of("place", "ward a"));
        robot.call("robot.say", Map.of("text", "Good evening."));
        Object answer = robot.call("robot.ask",
            Map.of("question", "Would you like some tea?", "options", List.of("yes", "no")));
        System.out.println("The answer: " + answer);
        try {
            robot.call("robot.goto", Map.of("place", "swimming pool"));
        } catch (RobotError error) {
            if (!error.name.equals("UnknownPlace")) throw error;
            System.out.println("As expected: " + error.getMessage());
        }
        System.out.println("On the way back.");
        robot.call("robot.goto", Map.of("place", "lobby"));
    }

    private static void stop(Robot robot) {
        try {
            robot.call("robot.stop", Map.of("who", "the tour"));
            System.out.println("The robot stands.");
        } catch (RobotError error) {
            System.out.println(error.getMessage());
        }
    }
}

/** What went wrong, in a sentence; {@code name} is its name on the wire, such as "Blocked". */
class RobotError extends RuntimeException {
    private static final long serialVersionUID = 1;
    final String name;

    RobotError(String name, String sentence) {
        super(sentence);
        this.name = name;
    }
}

/** What is done with the data of an event. */
interface EventListener {
    void told(Map<?, ?> data);
}

/** A connection to a robot's server. Calls from several threads run side by side. */
class Robot implements WebSocket.Listener {
    private final AtomicLong ids = new AtomicLong();
    private final Map<Long, CompletableFuture<Object>> waiting = new ConcurrentHashMap<>();
    private final Map<String, EventListener> listeners = new ConcurrentHashMap<>();
    private final StringBuilder frame = new StringBuilder();
    private final WebSocket socket;
    private volatile boolean lost;

    Robot(String address, String token) {
        WebSocket.Builder builder = HttpClient.newHttpClient().newWebSocketBuilder();
        if (token != null) builder.header("Authorization", "Bearer " + token);
        try {
            socket = builder.buildAsync(URI.create(address), this).join();
        } catch (CompletionException failed) {
            if (failed.getCause() instanceof WebSocketHandshakeException)
                throw new RobotError("AccessDenied", "The robot's server does not let this in. Is the token right?");
            throw new RobotError("LostConnection", "There is no robot at " + address + ".");
        }
    }

    /** Call a method and wait for its result. Whatever is in flight, {@code robot.stop} overtakes it. */
    Object call(String method, Map<String, ?> params) {
        long id = ids.incrementAndGet();
        CompletableFuture<Object> answer = new CompletableFuture<>();
        waiting.put(id, answer);
        if (lost) lose();
        else send(Json.write(Map.of("jsonrpc", "2.0", "id", id, "method", method, "params", params)));
        try {
            return answer.join();
        } catch (CompletionException failed) {
            throw (RobotError) failed.getCause();
        }
    }

    /** Be told of a kind of event, in the thread that reads: call nothing from there. */
    void listen(String kind, EventListener listener) {
        listeners.put("event." + kind, listener);
        call("rpc.subscribe", Map.of("events", List.of(kind)));
    }

    void close() {
        socket.sendClose(WebSocket.NORMAL_CLOSURE, "");
    }

    /** One frame after the other: this WebSocket refuses a second one before the first has gone. */
    private synchronized void send(String text) {
        try {
            socket.sendText(text, true).join();
        } catch (CompletionException failed) {
            lose();
        }
    }

    @Override
    public CompletionStage<?> onText(WebSocket from, CharSequence part, boolean last) {
        frame.append(part);
        if (last) {
            Map<?, ?> message = (Map<?, ?>) Json.read(frame.toString());
            frame.setLength(0);
            receive(message);
        }
        from.request(1);
        return null;
    }

    @Override
    public CompletionStage<?> onClose(WebSocket from, int status, String reason) {
        lose();
        return null;
    }

    @Override
    public void onError(WebSocket from, Throwable error) {
        lose();
    }

    private void receive(Map<?, ?> message) {
        EventListener listener = listeners.get(String.valueOf(message.get("method")));
        if (listener != null) listener.told((Map<?, ?>) message.get("params"));
        if (!(message.get("id") instanceof Number)) return;
        CompletableFuture<Object> answer = waiting.remove(((Number) message.get("id")).longValue());
        if (answer == null) return;
        Map<?, ?> error = (Map<?, ?>) message.get("error");
        if (error == null) {
            answer.complete(message.get("result"));
            return;
        }
        Map<?, ?> data = (Map<?, ?>) error.get("data");
        String name = data == null ? "RobotError" : String.valueOf(data.get("error"));
        answer.completeExceptionally(new RobotError(name, String.valueOf(error.get("message"))));
    }

    /** What is in flight is never sent again: the robot may have done it. */
    private void lose() {
        lost = true;
        for (CompletableFuture<Object> each : waiting.values())
            each.completeExceptionally(new RobotError("LostConnection", "The connection to the robot was lost."));
    }
}

/** JSON, for a file that needs nothing else. In a program of yours, take a library such as Jackson. */
class Json {
    private final String text;
    private int at;

    private Json(String text) {
        this.text = text;
    }

    static String write(Object value) {
        if (value instanceof Map)
            return ((Map<?, ?>) value).entrySet().stream()
                .map(each -> write(each.getKey()) + ":" + write(each.getValue()))
                .collect(Collectors.joining(",", "{", "}"));
        if (value instanceof List)
            return ((List<?>) value).stream().map(Json::write).collect(Collectors.joining(",", "[", "]"));
        if (!(value instanceof String)) return String.valueOf(value);
        StringBuilder quoted = new StringBuilder("\"");
        for (char sign : ((String) value).toCharArray()) {
            if (sign < ' ') quoted.append(String.format("\\u%04x", (int) sign));
            else quoted.append(sign == '"' || sign == '\\' ? "\\" : "").append(sign);
        }
        return quoted.append('"').toString();
    }

    static Object read(String text) {
        return new Json(text).value();
    }

    private Object value() {
        switch (next()) {
            case '{':
                Map<String, Object> fields = new LinkedHashMap<>();
                for (at++; next() != '}'; skip(',')) {
                    String name = string();
                    skip(':');
                    fields.put(name, value());
                }
                at++;
                return fields;
            case '[':
                List<Object> items = new ArrayList<>();
                for (at++; next() != ']'; skip(',')) items.add(value());
                at++;
                return items;
            case '"':
                return string();
            default:
                int start = at;
                while (at < text.length() && ",]} \n".indexOf(text.charAt(at)) < 0) at++;
                String word = text.substring(start, at);
                if (word.equals("null")) return null;
                if (word.equals("true") || word.equals("false")) return Boolean.valueOf(word);
                return Double.valueOf(word);
        }
    }

    private String string() {
        StringBuilder read = new StringBuilder();
        next();
        for (at++; text.charAt(at) != '"'; at++) {
            char sign = text.charAt(at);
            if (sign == '\\') {
                sign = text.charAt(++at);
                if (sign == 'u') {
                    sign = (char) Integer.parseInt(text.substring(at + 1, at + 5), 16);
                    at += 4;
                } else if ("bfnrt".indexOf(sign) >= 0) sign = "\b\f\n\r\t".charAt("bfnrt".indexOf(sign));
            }
            read.append(sign);
        }
        at++;
        return read.toString();
    }

    /** The sign that comes next, blanks left out. */
    private char next() {
        while (" \n\r\t".indexOf(text.charAt(at)) >= 0) at++;
        return text.charAt(at);
    }

    private void skip(char sign) {
        if (next() == sign) at++;
    }
}
