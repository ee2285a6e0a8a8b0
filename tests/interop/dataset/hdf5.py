"""hdf5.py FOLDER: robomimic's and ALOHA's files hold what the descriptions of their layouts say, and
the values that the recording holds, interpolated here a second time, by numpy."""
import csv
import json
import sys
from pathlib import Path

import h5py
import numpy as np

folder = Path(sys.argv[1])
RATE = 30


def commands():
    """Log times and commanded DoFs of the recording's table."""
    with open(folder / "commands.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    times = np.array([int(row["log_time_ns"]) for row in rows])
    dofs = np.array([json.loads(row["dof"]) for row in rows])
    places = np.array([[float(row[f"X_WB.position.{axis}"]) for axis in "xyz"] for row in rows])
    turns = np.array([[float(row[f"X_WB.orientation.{axis}"]) for axis in "wxyz"] for row in rows])
    return times, dofs, places, turns


def straight(times, values, begin_ns, count):
    """At the fixed rate; gaps of more than half a second are not bridged."""
    at = begin_ns + np.round(np.arange(count) / RATE * 1e9).astype(np.int64)
    before = np.clip(np.searchsorted(times, at, side="right") - 1, 0, len(times) - 1)
    after = np.minimum(before + 1, len(times) - 1)
    gap = times[after] - times[before]
    share = np.where((gap > 0) & (gap <= 500_000_000), (at - times[before]) / np.maximum(gap, 1), 0)
    share = np.clip(share, 0, 1)[:, None]
    return (1 - share) * values[before] + share * values[after], before, after, share


def check_robomimic():
    with h5py.File(folder / "robomimic.hdf5", "r") as file:
        data = file["data"]
        environment = json.loads(data.attrs["env_args"])
        assert set(environment) >= {"env_name", "type", "env_kwargs"}
        demos = sorted(data, key=lambda name: int(name[5:]))
        assert demos == [f"demo_{i}" for i in range(len(demos))]
        assert data.attrs["total"] == sum(data[demo].attrs["num_samples"] for demo in demos)
        for mask in file["mask"].values():
            assert all(name.decode("utf-8") in data for name in mask[:])
        for name in demos:
            demo = data[name]
            count = demo.attrs["num_samples"]
            actions = demo["actions"][:]
            assert actions.shape[0] == count and actions.ndim == 2
            assert np.abs(actions).max() <= 1
            low, high = data.attrs["action_min"], data.attrs["action_max"]
            meant = low + (actions + 1) / 2 * (high - low)
            moving = high > low
            np.testing.assert_allclose(meant[:, moving], demo["actions_abs"][:][:, moving], atol=1e-9)
            assert demo["states"].shape[0] == count
            assert demo["rewards"].shape == demo["dones"].shape == (count,)
            assert demo["dones"][-1] == 1 and demo["dones"][:-1].sum() == 0
            held = name.encode() in file["mask/success"][:]
            assert demo["rewards"][-1] == held == demo.attrs["success"]
            assert json.loads(demo.attrs["ep_meta"])["lang"] == demo.attrs["task"]
            assert set(demo["obs"]) == set(demo["next_obs"])
            for key, values in demo["obs"].items():
                following = demo["next_obs"][key]
                assert values.shape == following.shape and values.shape[0] == count
                assert values.dtype == following.dtype
                np.testing.assert_array_equal(values[1:], following[:-1])
            for key in ("state", "joint_position", "touch_force", "touch_slip", "fingertips", "object"):
                assert key in demo["obs"], key
            pictures = demo["obs/camera_image"]
            assert pictures.dtype == np.uint8 and pictures.shape[1:] == (60, 84, 3)
            assert pictures[:].std() > 10
        return data["demo_0/actions_abs"][:], data["demo_0/obs/state"][:], data["demo_0"].attrs["begin_ns"]


def check_aloha():
    with h5py.File(folder / "aloha/episode_0.hdf5", "r") as file:
        assert file.attrs["sim"] and isinstance(file.attrs["sim"], (bool, np.bool_))
        assert file.attrs["compress"]
        count = file["action"].shape[0]
        width = file["action"].shape[1]
        assert len(file.attrs["columns"].split(",")) == width
        for name in ("qpos", "qvel", "effort"):
            assert file[f"observations/{name}"].shape == (count, width), name
        pictures = file["observations/images/camera"]
        lengths = file["compress_len"][:]
        assert pictures.dtype == np.uint8 and pictures.shape[0] == count
        assert lengths.shape == (1, count)
        for picture, length in zip(pictures[:], lengths[0].astype(int)):
            assert bytes(picture[:2]) == b"\xff\xd8" and bytes(picture[length - 2 : length]) == b"\xff\xd9"
            assert not picture[length:].any()
        action, qpos = file["action"][:], file["observations/qpos"][:]
    with h5py.File(folder / "raw/episode_0.hdf5", "r") as file:
        assert not file.attrs["compress"]
        assert file["observations/images/camera"].shape == (count, 60, 84, 3)
    return action, qpos


def check_values(actions, begin_ns):
    times, dofs, places, turns = commands()
    count = len(actions)
    width = dofs.shape[1]
    expected, before, after, share = straight(times, dofs, begin_ns, count)
    np.testing.assert_allclose(actions[:, :width], expected, atol=1e-6)
    expected, *_ = straight(times, places, begin_ns, count)
    np.testing.assert_allclose(actions[:, width : width + 3], expected, atol=1e-6)
    # Slerp by its formula, of quaternions that lie on the same side.
    one, other = turns[before], turns[after]
    cosine = np.sum(one * other, axis=1, keepdims=True)
    other = np.where(cosine < 0, -other, other)
    angle = np.arccos(np.clip(np.abs(cosine), -1, 1))
    small = angle < 1e-6
    sine = np.where(small, 1, np.sin(angle))
    mixed = np.where(small, (1 - share) * one + share * other,
                     (np.sin((1 - share) * angle) * one + np.sin(share * angle) * other) / sine)
    found = actions[:, width + 3 :]
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), 1, atol=1e-9)
    np.testing.assert_allclose(np.abs(np.sum(mixed * found, axis=1)), 1, atol=1e-9)
    assert (np.sum(found[1:] * found[:-1], axis=1) > 0).all()  # no sign jumps


actions, state, begin_ns = check_robomimic()
check_values(actions, begin_ns)
action, qpos = check_aloha()
np.testing.assert_allclose(action, actions, atol=1e-6)
np.testing.assert_allclose(qpos, state, atol=1e-6)
print(f"{len(actions)} rows of {actions.shape[1]} numbers are those of the recording")
