// A run by Foxglove's WebSocket protocol, by its own client. Usage: node subscribe.cjs NODE_MODULES URL TOPIC=COUNT...
// Prints channels, and number, first and last message of each topic, once so many messages have come.
const { createRequire } = require('node:module');
const { join, resolve } = require('node:path');

const [modules, url, ...wanted] = process.argv.slice(2);
const from = createRequire(join(resolve(modules), 'x.js'));
const { FoxgloveClient } = from('@foxglove/ws-protocol');
const protobuf = from('protobufjs'), descriptor = from('protobufjs/ext/descriptor'), WebSocket = from('ws');

const counts = new Map(wanted.map((one) => one.split('=')).map(([topic, count]) => [topic, Number(count)]));
const channels = {}, subscriptions = new Map(), topics = {};
const client = new FoxgloveClient({ ws: new WebSocket(url, [FoxgloveClient.SUPPORTED_SUBPROTOCOL]) });
const fail = (error) => { console.error(String(error?.message ?? error)); process.exit(1); };
client.on('error', fail);
client.on('status', (status) => fail(JSON.stringify(status)));
client.on('close', () => fail('closed'));
let info;
client.on('serverInfo', (message) => { info = message; });
client.on('advertise', (advertised) => {
  for (const channel of advertised) {
    channels[channel.topic] = channel.schemaName;
    if (!counts.has(channel.topic)) continue;
    const set = descriptor.FileDescriptorSet.decode(Buffer.from(channel.schema, 'base64'));
    subscriptions.set(client.subscribe(channel.id), { topic: channel.topic, type: protobuf.Root.fromDescriptor(set).lookupType(channel.schemaName) });
  }
});
client.on('message', ({ subscriptionId, timestamp, data }) => {
  const { topic, type } = subscriptions.get(subscriptionId);
  const message = { time_ns: String(timestamp), ...type.toObject(type.decode(new Uint8Array(data.buffer, data.byteOffset, data.byteLength)), { defaults: true, longs: String, enums: String }) };
  topics[topic] ??= { count: 0, first: message };
  topics[topic].count += 1;
  topics[topic].last = message;
  if ([...counts].every(([name, count]) => (topics[name]?.count ?? 0) >= count)) {
    console.log(JSON.stringify({ info, channels, topics }));
    process.exit(0);
  }
});
setTimeout(() => fail(`after 50 s: ${JSON.stringify(Object.fromEntries(Object.entries(topics).map(([name, { count }]) => [name, count])))}`), 50000);
