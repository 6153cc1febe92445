// Reads an MCAP file by @mcap/core and its messages by protobufjs, from the descriptors in the file: node read_mcap.cjs NODE_MODULES FILE
const { createRequire } = require('node:module');
const { readFileSync } = require('node:fs');
const { join } = require('node:path');

const [modules, file] = process.argv.slice(2);
const load = createRequire(join(modules, 'x.js'));
const { McapIndexedReader } = load('@mcap/core');
const protobuf = load('protobufjs');
const descriptor = load('protobufjs/ext/descriptor');

const bytes = readFileSync(file);
const readable = {
  size: async () => BigInt(bytes.length),
  read: async (offset, length) => new Uint8Array(bytes.subarray(Number(offset), Number(offset + length))),
};

(async () => {
  const reader = await McapIndexedReader.Initialize({ readable });
  const types = new Map(), topics = {};
  for (const [id, schema] of reader.schemasById) {
    const root = protobuf.Root.fromDescriptor(descriptor.FileDescriptorSet.decode(schema.data));
    root.resolveAll();
    types.set(id, root.lookupType(schema.name));
  }
  let before = 0n;
  for await (const message of reader.readMessages()) {
    if (message.logTime < before) throw new Error('messages are not in order of time');
    before = message.logTime;
    const channel = reader.channelsById.get(message.channelId), type = types.get(channel.schemaId);
    const value = type.toObject(type.decode(message.data), { longs: String, enums: String, bytes: String, arrays: true });
    const topic = (topics[channel.topic] ??= { schema: reader.schemasById.get(channel.schemaId).name, count: 0, first: value, first_time: String(message.logTime) });
    topic.count += 1;
    topic.last = value;
  }
  const statistics = Object.fromEntries([...reader.statistics.channelMessageCounts].map(([id, count]) => [reader.channelsById.get(id).topic, Number(count)]));
  const text = JSON.stringify({ topics, statistics, chunks: reader.chunkIndexes.length }, (_, value) => (Number.isNaN(value) ? 'NaN' : value));
  process.stdout.write(text);
})().catch((error) => { console.error(error); process.exit(1); });
