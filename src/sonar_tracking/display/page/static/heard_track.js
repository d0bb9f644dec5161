// Which beam, and which track, the operator's choice means for the views of one target.

import { bearingTopics, pictureTopics, rowOf } from "./picture.js";

const TMA = 1;

/** Sensors whose samples are heard: those with broadband rows. */
export function sampledSensors(history) {
  const sensors = new Set();
  for (const name of history.names("waterfall")) {
    const stream = history.stream(name);
    const frame = stream.frames[stream.frames.length - 1];
    if (frame?.content === "broadband") sensors.add(frame.sensor);
  }
  return sensors;
}

/** Bearing tracks of the sampled sensors at a time: [{sensor, track, topic}]. */
export function heardTracks(history, t) {
  const sensors = sampledSensors(history);
  const heard = [];
  for (const topic of bearingTopics(history)) {
    const frame = history.at(`bearings ${topic}`, t);
    if (!frame || !sensors.has(frame.sensor.id)) continue;
    for (let i = 0; i < frame.id.length; i++) {
      if (frame.status[i] === 1 || frame.status[i] === 2) heard.push({ sensor: frame.sensor.id, track: frame.id[i], topic });
    }
  }
  return heard;
}

/** The beam of the choice: {sensor, track} or {sensor, beam}; null where it has none. */
export function chosenBeam(history, choice, t) {
  if (!choice) return null;
  if (choice.sensor !== undefined) return { sensor: choice.sensor, track: 0, beam: choice.beam };
  const sensors = sampledSensors(history);
  const bearings = history.at(`bearings ${choice.topic}`, t);
  if (bearings) return sensors.has(bearings.sensor.id) ? { sensor: bearings.sensor.id, track: choice.id } : null;
  const row = trackRow(history, choice, t);
  if (!row) return null;
  const part = row.contributors.find(([, source, sensor]) => source === TMA && sensors.has(sensor));
  if (part) return { sensor: part[2], track: part[3] };
  const [only] = sensors;
  return row.bearingTrack && only !== undefined && !row.contributors.length ? { sensor: only, track: row.bearingTrack } : null;
}

/** The row of a chosen position track at a time; null if it is none, or not there. */
export function trackRow(history, choice, t) {
  const frame = choice ? history.at(`tracks ${choice.topic}`, t) : null;
  if (!frame) return null;
  const i = frame.id.indexOf(choice.id);
  return i < 0 ? null : rowOf(frame, choice.topic, i);
}

/** The position track the choice means: itself, or that of a bearing track. */
export function chosenTrack(history, choice, t) {
  if (!choice || choice.topic === undefined) return null;
  if (history.stream(`tracks ${choice.topic}`)) return choice;
  const bearings = history.at(`bearings ${choice.topic}`, t);
  if (!bearings) return null;
  for (const topic of pictureTopics(history)) {
    const frame = history.at(`tracks ${topic}`, t);
    const part = frame?.contributors.find(([, source, sensor, id]) => source === TMA && sensor === bearings.sensor.id && id === choice.id);
    if (part) return { topic, id: frame.id[part[0]] };
  }
  return null;
}

/**
 * Ask the server for what a view shows: once, and again where the connection or the data begin anew.
 * Returns whether it was asked now.
 */
export function askFor(view, page, key, what) {
  const { socket, history, incoming } = page;
  if (!socket.open || incoming) return false;
  if (view.asked === key && view.askedBy === socket.link && view.askedIn === history.version) return false;
  Object.assign(view, { asked: key, askedBy: socket.link, askedIn: history.version });
  return socket.send({ kind: "select", ...what });
}
