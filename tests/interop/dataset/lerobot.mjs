// lerobot.mjs FOLDER: a dataset of version 3.0 or 2.1 holds together: files are where meta/info.json
// says, columns are the features, episodes follow each other, statistics are those of the values.
import assert from "node:assert/strict";
import { existsSync, readFileSync, statSync } from "node:fs";
import { read } from "./readers.mjs";

const folder = process.argv[2];
const json = (name) => JSON.parse(readFileSync(`${folder}/${name}`, "utf8"));
const lines = (name) =>
  readFileSync(`${folder}/${name}`, "utf8").trim().split("\n").map((line) => JSON.parse(line));
const info = json("meta/info.json");
const old = info.codebase_version === "v2.1";
if (!old) assert.equal(info.codebase_version, "v3.0");
assert.ok(Number.isInteger(info.fps));

/// As Python's str.format does with {name} and {name:03d}.
const format = (pattern, values) =>
  pattern.replace(/\{(\w+)(?::0(\d)d)?\}/g, (_, name, width) =>
    String(values[name]).padStart(Number(width ?? 0), "0"));

async function episodesAndTasks() {
  if (old) {
    const tasks = lines("meta/tasks.jsonl");
    tasks.forEach((task, i) => assert.equal(task.task_index, i));
    let from = 0;
    const episodes = lines("meta/episodes.jsonl").map((episode) => {
      const chunk = Math.floor(episode.episode_index / info.chunks_size);
      const place = { episode_chunk: chunk, episode_index: episode.episode_index };
      const videos = (key) => ({ ...place, video_key: key });
      from += episode.length;
      return { ...episode, place, videos, from: from - episode.length };
    });
    return { episodes, tasks: tasks.map(({ task }) => task) };
  }
  const tasks = await read(`${folder}/meta/tasks.parquet`);
  const pandas = JSON.parse(tasks.metadata.pandas);
  const index = pandas.index_columns[0];
  tasks.columns.task_index.forEach((number, i) => assert.equal(number, i));
  const { columns } = await read(`${folder}/meta/episodes/chunk-000/file-000.parquet`);
  const episodes = columns.episode_index.map((number, i) => {
    const of = (name) => columns[name][i];
    assert.equal(of("dataset_to_index"), of("dataset_from_index") + of("length"));
    const videos = (key) => ({
      video_key: key,
      chunk_index: of(`videos/${key}/chunk_index`),
      file_index: of(`videos/${key}/file_index`),
      from: of(`videos/${key}/from_timestamp`),
      to: of(`videos/${key}/to_timestamp`),
    });
    return {
      episode_index: number,
      tasks: of("tasks"),
      length: of("length"),
      from: of("dataset_from_index"),
      place: { chunk_index: of("data/chunk_index"), file_index: of("data/file_index") },
      videos,
    };
  });
  return { episodes, tasks: tasks.columns[index] };
}

const { episodes, tasks } = await episodesAndTasks();
assert.equal(episodes.length, info.total_episodes);
assert.equal(tasks.length, info.total_tasks);
assert.equal(info.splits.train, `0:${episodes.length}`);

// The rows of all files, in order.
const files = [...new Set(episodes.map(({ place }) => format(info.data_path, place)))];
const data = {};
const arrow = { float32: "Float32", int64: "Int64", bool: "Bool" };
const numeric = Object.entries(info.features).filter(([, { dtype }]) => dtype !== "video");
for (const file of files) {
  const { columns, types } = await read(`${folder}/${file}`);
  assert.deepEqual(Object.keys(columns).sort(), numeric.map(([name]) => name).sort());
  for (const [name, { dtype, shape, names }] of numeric) {
    const many = shape[0] > 1;
    assert.equal(types[name], many ? `List<${arrow[dtype]}>` : arrow[dtype], name);
    if (many) for (const value of columns[name]) assert.equal(value.length, shape[0], name);
    if (many) assert.equal(names.length, shape[0], name);
    data[name] = (data[name] ?? []).concat(columns[name]);
  }
}
assert.equal(data.index.length, info.total_frames);
data.index.forEach((number, i) => assert.equal(number, i));
for (const name of ["observation.state", "action", "observation.fingertips", "observation.touch_force", "timestamp"])
  assert.ok(data[name], `${name} is missing`);
assert.deepEqual(info.features.action.names, info.features["observation.state"].names);

let next = 0;
for (const episode of episodes) {
  assert.equal(episode.from, next);
  for (let k = 0; k < episode.length; ++k, ++next) {
    assert.equal(data.episode_index[next], episode.episode_index);
    assert.equal(data.frame_index[next], k);
    assert.equal(data.timestamp[next], Math.fround(k / info.fps));
    assert.equal(tasks[data.task_index[next]], episode.tasks[0]);
    assert.equal(data["next.done"][next], k === episode.length - 1);
  }
  for (const [key, { dtype }] of Object.entries(info.features)) {
    if (dtype !== "video") continue;
    const place = episode.videos(key);
    const video = `${folder}/${format(info.video_path, place)}`;
    assert.ok(existsSync(video) && statSync(video).size > 1000, video);
    if (!old) assert.ok(Math.abs(place.to - place.from - episode.length / info.fps) < 1e-9);
  }
}
assert.equal(next, info.total_frames);

/// Of each column of some rows.
function statistics(values) {
  const rows = values.map((value) => [value].flat().map(Number));
  const columns = rows[0].map((_, i) => rows.map((row) => row[i]));
  const mean = columns.map((column) => column.reduce((a, b) => a + b, 0) / column.length);
  return {
    min: columns.map((column) => Math.min(...column)),
    max: columns.map((column) => Math.max(...column)),
    mean,
    std: columns.map((column, i) =>
      Math.sqrt(column.reduce((a, b) => a + (b - mean[i]) ** 2, 0) / column.length)),
    count: [rows.length],
  };
}
function compare(stated, values, name) {
  const found = statistics(values);
  assert.deepEqual(Object.keys(stated), ["min", "max", "mean", "std", "count"], name);
  for (const what of Object.keys(stated)) {
    stated[what].forEach((number, i) => {
      // Single precision of the values, and of what they differ by.
      const scale = Math.max(1, ...found.max.map(Math.abs), ...found.min.map(Math.abs));
      assert.ok(Math.abs(number - found[what][i]) <= 1e-6 * scale, `${name} ${what} ${i}`);
    });
  }
}
for (const [name] of numeric) {
  if (!old) {
    compare(json("meta/stats.json")[name], data[name], name);
    continue;
  }
  for (const { episode_index, stats } of lines("meta/episodes_stats.jsonl")) {
    const { from, length } = episodes[episode_index];
    compare(stats[name], data[name].slice(from, from + length), name);
  }
}
const pictures = Object.entries(info.features).filter(([, { dtype }]) => dtype === "video");
const shown = old ? lines("meta/episodes_stats.jsonl")[0].stats : json("meta/stats.json");
for (const [name] of pictures) {
  assert.equal(shown[name].mean.length, 3);
  for (const [[value]] of shown[name].mean) assert.ok(value > 0.02 && value < 0.98, name);
}
console.log(`${folder}: ${info.codebase_version}, ${episodes.length} episodes, ` +
  `${info.total_frames} rows, ${numeric.length} features, ${pictures.length} cameras`);
