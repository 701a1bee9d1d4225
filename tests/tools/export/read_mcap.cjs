// node read_mcap.cjs NODE_MODULES FILE.mcap
//
// Reads an MCAP file with the reference reader, through its index and from front to end, checksums included, and prints
// what both found as JSON.
"use strict";
const fs = require("fs");
const path = require("path");
const { McapIndexedReader, McapStreamReader } = require(path.join(process.argv[2], "@mcap/core"));

const bytes = fs.readFileSync(process.argv[3]);
const text = (data) => new TextDecoder("utf-8", { fatal: true }).decode(data);

function take(message, channel, found) {
  const json = text(message.data);
  JSON.parse(json); // as a viewer does
  (found[channel.topic] ??= []).push({
    log_time: String(message.logTime),
    publish_time: String(message.publishTime),
    sequence: message.sequence,
    json,
  });
}

async function indexed() {
  const reader = await McapIndexedReader.Initialize({
    readable: {
      size: async () => BigInt(bytes.length),
      read: async (offset, length) => new Uint8Array(bytes.subarray(Number(offset), Number(offset + length))),
    },
  });
  const found = {};
  let last = 0n;
  for await (const message of reader.readMessages()) {
    if (message.logTime < last) throw new Error("messages are not in the order of their time");
    last = message.logTime;
    take(message, reader.channelsById.get(message.channelId), found);
  }
  const schemas = {};
  for (const channel of reader.channelsById.values()) {
    const schema = reader.schemasById.get(channel.schemaId);
    schemas[channel.topic] = {
      name: schema.name,
      encoding: schema.encoding,
      message_encoding: channel.messageEncoding,
      schema: JSON.parse(text(schema.data)),
    };
  }
  const s = reader.statistics;
  return {
    messages: found,
    schemas,
    library: reader.header.library,
    chunks: reader.chunkIndexes.length,
    statistics: { messages: Number(s.messageCount), chunks: s.chunkCount, channels: s.channelCount },
  };
}

function streamed() {
  const reader = new McapStreamReader({ validateCrcs: true });
  const channels = new Map();
  const found = {};
  let ended = false;
  reader.append(bytes);
  for (let record; (record = reader.nextRecord()); ) {
    if (record.type === "DataEnd") ended = true;
    if (record.type === "Channel") channels.set(record.id, record);
    if (record.type === "Message") take(record, channels.get(record.channelId), found);
  }
  if (!reader.done() || !ended) throw new Error("the file is not complete");
  return { messages: found };
}

indexed().then((result) => {
  process.stdout.write(JSON.stringify({ indexed: result, streamed: streamed() }));
});
