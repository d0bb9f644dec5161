// Who is who: the track of the picture that a bearing track, or a track of echoes, is part of.
//
// An operator knows a target by one number and one colour, whichever view it is in. Tracks that are
// part of no track of the picture have a letter before their own number, and no colour.

import { palette } from "./palette.js";
import { SOURCE_CODE, pictureTopics, tracksAt } from "./picture.js";

export class Identities {
  constructor(history, selection, t) {
    this.selection = selection;
    this.picture = new Set(pictureTopics(history));
    this.owners = new Map();
    for (const row of tracksAt(history, t, [...this.picture])) {
      for (const [, source, sensor, id] of row.contributors) {
        this.keep(source === SOURCE_CODE.tma ? `bearing ${sensor} ${id}` : `echo ${id}`, row);
      }
      if (row.bearingTrack && !row.contributors.length) this.keep(`bearing ${row.bearingTrack}`, row);
    }
  }

  keep(key, row) {
    if (!this.owners.has(key)) this.owners.set(key, row);
  }

  /** The track of the picture that {topic, id, sensor} is, or is part of; null = none. */
  ownerOf({ topic, id, sensor }) {
    if (this.picture.has(topic)) return { topic, id };
    if (sensor === undefined) return this.owners.get(`echo ${id}`) ?? null;
    return this.owners.get(`bearing ${sensor} ${id}`) ?? this.owners.get(`bearing ${id}`) ?? null;
  }

  nameOf(track) {
    const owner = this.ownerOf(track);
    if (owner) return this.selection.nameOf(owner.topic, owner.id);
    const own = this.selection.nameOf(track.topic, track.id);
    const letter = track.sensor === undefined ? "e" : "b";
    return this.picture.size && own === String(track.id) ? `${letter}${own}` : own;
  }

  colourOf(track) {
    const owner = this.ownerOf(track);
    if (owner) return palette.track(owner.id);
    return this.picture.size ? palette.faint : palette.track(track.id);
  }

  isChosen(track) {
    const owner = this.ownerOf(track);
    const { selection } = this;
    return selection.isChosen(track.topic, track.id) || Boolean(owner && selection.isChosen(owner.topic, owner.id));
  }

  /** What a click on a track chooses: the track of the picture, or itself. */
  choiceOf(track) {
    const { topic, id } = this.ownerOf(track) ?? track;
    return { topic, id };
  }
}
