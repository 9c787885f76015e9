// Reads, codes and decodes MAVLink with node-mavlink, for the test of our own codec.
//
// In, one JSON object per line:  {"id": 0, "packet": "<hex, by our codec>", "signed": "<the same, signed>", "key": "<hex>",
//                                 "fields": {"custom_mode": "4", ...}}
// Out, one line for each:        {"id", "name", "crc_extra", "base_length", "full_length",
//                                 "fields": <what node-mavlink reads from the packet>,
//                                 "is_signature_right": <of the signed one>,
//                                 "v1", "v2", "signed": <hex of what it makes of the fields>}
// Numbers travel as strings, so that 64 bits survive.
const readline = require('readline');
const {MavLinkPacketParser, MavLinkPacketSplitter, MavLinkProtocolV1, MavLinkProtocolV2} = require('node-mavlink');
const {minimal, standard, common, ardupilotmega} = require('node-mavlink');
const registry = {...minimal.REGISTRY, ...standard.REGISTRY, ...common.REGISTRY, ...ardupilotmega.REGISTRY};

const isText = (field) => field.type === 'char[]';
const isWide = (field) => /int64/.test(field.type);
const fromText = (field, text) => (isWide(field) ? BigInt(text) : Number(text));
const toText = (value) => (Array.isArray(value) ? value.map(String) : String(value));

function readPacket(hex) {
  return new Promise((resolve, reject) => {
    const splitter = new MavLinkPacketSplitter();
    const parser = splitter.pipe(new MavLinkPacketParser());
    parser.on('data', resolve);
    parser.on('end', () => reject(new Error(`node-mavlink finds no packet in ${hex}`)));
    splitter.end(Buffer.from(hex, 'hex'));
  });
}

async function answer(line) {
  const question = JSON.parse(line);
  const type = registry[question.id];
  const packet = await readPacket(question.packet);
  const read = packet.protocol.data(packet.payload, type);
  const fields = {};
  const message = new type();
  for (const field of type.FIELDS) {
    fields[field.source] = toText(read[field.name]);
    const sent = question.fields[field.source];
    if (isText(field)) message[field.name] = sent;
    else if (field.length) message[field.name] = sent.map((text) => fromText(field, text));
    else message[field.name] = fromText(field, sent);
  }
  const base = type.FIELDS.filter((field) => !field.extension);
  const key = Buffer.from(question.key, 'hex');
  const signer = new MavLinkProtocolV2(1, 191, MavLinkProtocolV2.IFLAG_SIGNED);
  const end = (list) => Math.max(...list.map((field) => field.offset + field.size * Math.max(field.length, 1)));
  return {
    id: question.id,
    name: type.MSG_NAME,
    crc_extra: type.MAGIC_NUMBER,
    base_length: end(base),
    full_length: end(type.FIELDS),
    fields,
    is_signature_right: (await readPacket(question.signed)).signature.matches(key),
    signed: signer.sign(signer.serialize(message, 0), 3, key).toString('hex'),
    v1: question.id > 255 ? null : new MavLinkProtocolV1(1, 191).serialize(message, 0).toString('hex'),
    v2: new MavLinkProtocolV2(1, 191).serialize(message, 0).toString('hex'),
  };
}

async function main() {
  for await (const line of readline.createInterface({input: process.stdin})) {
    process.stdout.write(JSON.stringify(await answer(line)) + '\n');
  }
}
main().catch((problem) => {
  console.error(problem);
  process.exit(1);
});
