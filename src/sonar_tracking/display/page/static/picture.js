// Which of the topics make the picture, and how their rows are read.

export const STATUS = ["tentative", "confirmed", "coasted", "terminated"];
export const SOURCE = ["active", "TMA", "fused", "truth", "static", "smoothed"];
export const SIDE = ["", "left", "right"];
export const TERMINATED = 3;
export const SOURCE_CODE = { active: 0, tma: 1, fused: 2, truth: 3, fixed: 4, smoothed: 5 };

const PART = /(^|\/)(passive|active|truth|own_tracks)(\/|$)/;

export const isTruth = (topic) => /(^|\/)truth\//.test(topic);

/** The lists that are the picture: the fused one, or all where there is none. */
export function pictureTopics(history) {
  const all = history.topics("tracks").filter((topic) => !isTruth(topic) && !/own_tracks$/.test(topic));
  const fused = all.filter((topic) => !PART.test(topic));
  // Of several ships' pictures, own ship's is the one that is not below another.
  const depth = (topic) => topic.split("/").length;
  const least = Math.min(...fused.map(depth));
  return fused.length ? fused.filter((topic) => depth(topic) === least) : all;
}

export function truthTopics(history) {
  return history.topics("tracks").filter(isTruth);
}

export function bearingTopics(history) {
  return history.topics("bearings").filter((topic) => !isTruth(topic));
}

/** Rows of the picture at a time, as objects; ended tracks are left out. */
export function tracksAt(history, t, topics = pictureTopics(history), age = 30) {
  const rows = [];
  for (const topic of topics) {
    const frame = history.at(`tracks ${topic}`, t);
    if (!frame || t - frame.t > age) continue;
    for (let i = 0; i < frame.id.length; i++) {
      if (frame.status[i] !== TERMINATED) rows.push(rowOf(frame, topic, i));
    }
  }
  return rows;
}

export function rowOf(frame, topic, i) {
  return {
    key: `${topic} ${frame.id[i]}`,
    topic,
    t: frame.t,
    id: frame.id[i],
    status: frame.status[i],
    source: frame.source[i],
    x: frame.x[i],
    y: frame.y[i],
    vx: frame.vx[i],
    vy: frame.vy[i],
    pxx: frame.position_covariance[3 * i],
    pxy: frame.position_covariance[3 * i + 1],
    pyy: frame.position_covariance[3 * i + 2],
    vxx: frame.velocity_covariance[3 * i],
    vxy: frame.velocity_covariance[3 * i + 1],
    vyy: frame.velocity_covariance[3 * i + 2],
    existence: frame.existence_probability[i],
    observability: frame.observability[i],
    side: frame.hypothesis[i],
    sideProbability: frame.hypothesis_probability[i],
    bearingTrack: frame.bearing_track_id[i],
    initiated: frame.initiated[i],
    updated: frame.updated[i],
    contributors: frame.contributors.filter((entry) => entry[0] === i),
    lines: frame.lines.filter((entry) => entry[0] === i),
  };
}

/** Own ship's last state; one that is old is no longer hers. */
export function ownShipAt(history, t, age = 30) {
  const state = history.at("own_ship", t);
  return state && t - state.t <= age ? state : null;
}

/** Other ships of own side, by what they tell of themselves: objects with a name. */
export function otherShipsAt(history, t, age = 30) {
  const states = history.topics("ship").map((topic) => history.at(`ship ${topic}`, t));
  return states
    .filter((state) => state && t - state.t <= age)
    .map((state) => ({ ...state, name: state.topic.split("/").slice(1, -2).join("/") }));
}

/** Bearing, range, course and speed of a row, with deviations, as seen from own ship. */
export function polar(row, ship) {
  const dx = row.x - (ship?.x ?? NaN);
  const dy = row.y - (ship?.y ?? NaN);
  const range = Math.hypot(dx, dy);
  const speed = Math.hypot(row.vx, row.vy);
  const along = (xx, xy, yy, ux, uy) => Math.sqrt(Math.max(0, xx * ux * ux + 2 * xy * ux * uy + yy * uy * uy));
  const [ux, uy] = [dx / range, dy / range];
  const [wx, wy] = [row.vx / speed, row.vy / speed];
  return {
    azimuth: Math.atan2(dy, dx),
    range,
    course: Math.atan2(row.vy, row.vx),
    speed,
    rangeDeviation: along(row.pxx, row.pxy, row.pyy, ux, uy),
    azimuthDeviation: along(row.pxx, row.pxy, row.pyy, -uy, ux) / range,
    speedDeviation: along(row.vxx, row.vxy, row.vyy, wx, wy),
    courseDeviation: along(row.vxx, row.vxy, row.vyy, -wy, wx) / speed,
  };
}
