"""Foxglove's WebSocket protocol, version 1 (github.com/foxglove/ws-protocol, docs/spec.md), for the channels of a run that grows. Who subscribes to a
channel gets all its messages so far, then those that follow."""
import base64
import csv
import json
import struct
import threading
import time

from vbar import websocket
from vbar.page_server import Refusal
from vbar.recorded_tables import RecordedRun, RunError
from vbar.run_channels import RunChannels
from vbar.watched_run import Reader

SUBPROTOCOLS = ("foxglove.websocket.v1", "foxglove.sdk.v1")  # two names of the messages used here; the first that the client offers is selected
PERIOD_S = 0.25
MESSAGE_DATA = 1
WARNING, ERROR = 1, 2


class GrowingRun(RecordedRun):
    """The tables of a run folder as they grow."""

    def __init__(self, watched):
        self.folder, self.tables, self.reader = watched.folder, {}, Reader(watched, {})
        self.read_summary()

    def renew(self):
        while news := self.reader.new_rows():
            for name, table in news.items():
                columns = self.tables.setdefault(name, {column: [] for column in table["columns"]})
                for row in csv.reader(table["rows"]):
                    for column, cell in zip(columns.values(), row):
                        column.append(cell)


class Feed:
    """The messages of a run that goes on, made once for all clients."""

    def __init__(self, watched):
        self.watched, self.lock, self.renewed_s = watched, threading.Lock(), -PERIOD_S
        self.adverts, self.messages, self.next_number = {}, {}, 0
        self.channels = None

    def channel(self, topic, schema, descriptors):
        number, self.next_number = self.next_number, self.next_number + 1
        self.messages[number] = []
        self.adverts[number] = {"id": number, "topic": topic, "encoding": "protobuf", "schemaName": schema, "schemaEncoding": "protobuf",
                                "schema": base64.b64encode(descriptors).decode()}
        return number

    def add(self, channel, time_ns, message):
        self.messages[channel].append((time_ns, message))

    def drop(self, channel):
        del self.adverts[channel], self.messages[channel]

    def renew(self):
        """Looks for new rows, unless that was just done. A copy of the channels that there are."""
        with self.lock:
            if time.monotonic() - self.renewed_s >= PERIOD_S:
                ended = self.watched.has_ended()
                self.channels = self.channels or RunChannels(GrowingRun(self.watched), self)
                self.channels.run.renew()
                if "truth" in self.channels.run.tables:
                    self.channels.add_new(is_whole=ended)
                self.renewed_s = time.monotonic()
            return dict(self.adverts)

    def behind(self, places):
        """The messages of channels behind the places (channel: count) that a client has, in order of time."""
        with self.lock:
            news = [(time_ns, channel, message) for channel, count in places.items() for time_ns, message in self.messages.get(channel, ())[count:]]
        return sorted(news, key=lambda one: one[0])


class Session:
    """A client of the feed."""

    def __init__(self, connection, feed):
        self.connection, self.feed = connection, feed
        self.advertised, self.subscriptions, self.places = {}, {}, {}  # channels; {subscription: channel}; {channel: messages that the client has}

    def send(self, **message):
        self.connection.send(websocket.TEXT, json.dumps(message).encode())

    def begin(self, name):
        self.send(op="serverInfo", name=name, capabilities=[], metadata={})
        self.advertise()

    def advertise(self):
        channels = self.feed.renew()
        if gone := [number for number in self.advertised if number not in channels]:
            self.send(op="unadvertise", channelIds=gone)
            self.subscriptions = {number: channel for number, channel in self.subscriptions.items() if channel not in gone}
            for channel in gone:
                self.places.pop(channel, None)
        new = [advert for number, advert in channels.items() if number not in self.advertised]
        if new or not self.advertised:
            self.send(op="advertise", channels=new)
        self.advertised = channels

    def obey(self, opcode, data):
        try:
            message = json.loads(data) if opcode == websocket.TEXT else {}
            operation = message["op"]
            if operation == "subscribe":
                for one in message["subscriptions"]:
                    self.subscribe(one["id"], one["channelId"])
            elif operation == "unsubscribe":
                for number in message["subscriptionIds"]:
                    self.places.pop(self.subscriptions.pop(number, None), None)
            else:
                self.send(op="status", level=WARNING, message=f"op: found {json.dumps(operation)[:40]}; accepted: \"subscribe\", \"unsubscribe\"")
        except (ValueError, KeyError, TypeError, RecursionError):
            self.send(op="status", level=ERROR, message="accepted: JSON objects as docs/spec.md of the protocol states for subscribe and unsubscribe")

    def subscribe(self, number, channel):
        if type(number) is not int or not 0 <= number < 1 << 32 or number in self.subscriptions or channel in self.places or channel not in self.advertised:
            self.send(op="status", level=ERROR, message=f"subscription {json.dumps(number)[:20]} of channel {json.dumps(channel)[:20]}: "
                      "accepted: a number that is not in use, of a channel that is advertised and not subscribed")
            return
        self.subscriptions[number], self.places[channel] = channel, 0

    def send_news(self):
        numbers = {channel: number for number, channel in self.subscriptions.items()}
        for time_ns, channel, message in self.feed.behind(self.places):
            self.connection.send(websocket.BINARY, struct.pack("<BIQ", MESSAGE_DATA, numbers[channel], time_ns) + message)
            self.places[channel] += 1


def serve(viewer, feed):
    """Upgrades the request of a viewer to a WebSocket connection, and serves the feed until it leaves or the program ends."""
    offered = [name.strip() for name in viewer.headers.get("Sec-WebSocket-Protocol", "").split(",")]
    protocol = next((name for name in offered if name in SUBPROTOCOLS), None)
    key = viewer.headers.get("Sec-WebSocket-Key")
    if viewer.headers.get("Upgrade", "").lower() != "websocket" or not key or not protocol:
        raise Refusal(400, f"accepted: a WebSocket connection with the subprotocol {' or '.join(SUBPROTOCOLS)}")
    viewer.close_connection = True
    viewer.send_response(101)
    for header, value in (("Upgrade", "websocket"), ("Connection", "Upgrade"), ("Sec-WebSocket-Accept", websocket.accept_key(key)),
                          ("Sec-WebSocket-Protocol", protocol)):
        viewer.send_header(header, value)
    viewer.end_headers()
    viewer.wfile.flush()
    session = Session(websocket.Connection(viewer.connection), feed)
    try:
        session.begin("vbar")
        while not viewer.server.is_over.is_set():
            for message in session.connection.receive(PERIOD_S):
                session.obey(*message)
            session.advertise()
            session.send_news()
        raise websocket.Closed(1001, "the run has ended")
    except websocket.Closed as closed:
        session.connection.close(*closed.args)
    except RunError as error:
        session.send(op="status", level=ERROR, message=str(error))
        session.connection.close(1011, "the run has no messages")
