// A camera's pictures one after the other: what stands still is said again without another look,
// what moves is followed, what is gone is forgotten, what comes is found.
#include "services/recognition/core/detection/watcher.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/unit/recognition/fixture.hpp"

namespace prehend::recognition {
namespace {

constexpr double period = 0.1;  // s

class Table {
 public:
  Table()
      : scene_(*model::make_scene(catalogue(), 11, {})),
        watcher_(Detector(trained(), catalogue())) {
    scene_.objects.clear();
  }
  void put(const std::string& name, double x, double y, double yaw = 0) {
    std::erase_if(scene_.objects, [&](const auto& o) { return o.name == name; });
    scene_.objects.push_back({name, standing_pose(catalogue().find(name)->shape, {x, y, yaw})});
  }
  void take(const std::string& name) {
    std::erase_if(scene_.objects, [&](const auto& o) { return o.name == name; });
  }
  model::Scene& scene() { return scene_; }
  const Watcher& watcher() const { return watcher_; }

  std::vector<Track> look() {
    RenderOptions options;
    options.noise_seed = ++pictures_;
    options.samples = 1;
    const Time now = Time(seconds(period * static_cast<double>(pictures_)));
    gone_ = watcher_.expire(now);
    return *watcher_.look(now, renderer().render(scene_, lab_camera(), options), lab_camera());
  }
  std::vector<Track> look(int times) {
    std::vector<Track> tracks;
    for (int i = 0; i < times; ++i) tracks = look();
    return tracks;
  }
  const std::vector<std::uint32_t>& gone() const { return gone_; }

 private:
  model::Scene scene_;
  Watcher watcher_;
  std::uint64_t pictures_ = 0;
  std::vector<std::uint32_t> gone_;
};

const Track* find(const std::vector<Track>& tracks, const std::string& name) {
  const auto found = std::find_if(tracks.begin(), tracks.end(),
                                  [&](const Track& t) { return t.seen.name == name; });
  return found == tracks.end() ? nullptr : &*found;
}

double off(const Track& track, double x, double y) {
  return std::hypot(track.seen.at->x - x, track.seen.at->y - y);
}

TEST(Watcher, SteadyObjectsKeepTheirPoseAndCostNothing) {
  Table table;
  table.put("Cup", 0, 0);
  table.put("Uncle Ben's", 0.25, 0.1, 0.4);
  const auto first = table.look();
  ASSERT_EQ(first.size(), 2u);
  int fits = 0;
  for (int i = 0; i < 12; ++i) {
    const auto tracks = table.look();
    fits += table.watcher().fits();
    ASSERT_EQ(tracks.size(), 2u);
    for (const Track& before : first) {
      const Track* now = find(tracks, before.seen.name);
      ASSERT_TRUE(now);
      EXPECT_EQ(now->id, before.id);
      EXPECT_FALSE(now->moving);
      EXPECT_LT(off(*now, before.seen.at->x, before.seen.at->y), 1e-9);
    }
  }
  EXPECT_EQ(fits, 0);
  // Now and then they are measured again; the pose stays within a millimetre.
  for (int i = 0; i < 20; ++i)
    for (const Track& now : table.look()) {
      const Track* before = find(first, now.seen.name);
      EXPECT_LT(off(now, before->seen.at->x, before->seen.at->y), 0.001);
    }
}

TEST(Watcher, MovedObjectIsFollowedWithItsNumber) {
  Table table;
  table.put("Cup", 0, 0);
  const std::uint32_t id = table.look(2).at(0).id;
  for (int i = 1; i <= 6; ++i) {
    table.put("Cup", 0.03 * i, 0.01 * i);
    const auto tracks = table.look();
    const Track* cup = find(tracks, "Cup");
    ASSERT_TRUE(cup) << i;
    EXPECT_EQ(cup->id, id);
    EXPECT_TRUE(cup->moving) << i;
    EXPECT_LT(off(*cup, 0.03 * i, 0.01 * i), 0.006) << i;
  }
  const auto still = table.look(3);
  ASSERT_EQ(still.size(), 1u);
  EXPECT_FALSE(still[0].moving);
}

TEST(Watcher, WhatComesIsFoundAndWhatGoesIsForgottenAfterHalfASecond) {
  Table table;
  table.look(3);
  table.put("Talc", 0.1, 0.05);
  const Track* talc = nullptr;
  std::vector<Track> tracks;
  for (int i = 0; i < 4 && !talc; ++i) talc = find(tracks = table.look(), "Talc");
  ASSERT_TRUE(talc);
  const std::uint32_t id = talc->id;
  EXPECT_LT(off(*talc, 0.1, 0.05), 0.006);
  table.take("Talc");
  double gone_after = 0;
  for (int i = 1; i <= 8; ++i) {
    EXPECT_FALSE(find(table.look(), "Talc")) << i;
    if (table.gone() == std::vector<std::uint32_t>{id}) gone_after = period * i;
  }
  EXPECT_NEAR(gone_after, 0.6, 0.11);
}

TEST(Watcher, ObjectThatJumpsIsFoundElsewhere) {
  Table table;
  table.put("Russini", -0.2, 0.1, 0.3);
  ASSERT_EQ(table.look(2).size(), 1u);
  table.put("Russini", 0.2, -0.05, -0.2);
  const Track* seen = nullptr;
  std::vector<Track> tracks;
  for (int i = 0; i < 4 && !seen; ++i) seen = find(tracks = table.look(), "Russini");
  ASSERT_TRUE(seen);
  EXPECT_LT(off(*seen, 0.2, -0.05), 0.01);
}

TEST(Watcher, AnotherLightIsNoMovement) {
  Table table;
  table.put("Cup", 0.05, 0.02);
  const auto before = table.look(2);
  ASSERT_EQ(before.size(), 1u);
  for (int i = 0; i < 6; ++i) {
    table.scene().light.gain *= 0.97;
    const auto tracks = table.look();
    ASSERT_EQ(tracks.size(), 1u) << i;
    EXPECT_FALSE(tracks[0].moving);
    EXPECT_EQ(tracks[0].id, before[0].id);
  }
}

TEST(Watcher, SamePicturesSameAnswers) {
  const auto run = [] {
    Table table;
    table.put("Cup", 0, 0);
    std::vector<double> said;
    for (int i = 0; i < 5; ++i) {
      if (i == 2) table.put("Pringles", 0.2, 0.1);
      for (const Track& track : table.look())
        said.insert(said.end(), {double(track.id), track.seen.at->x, track.seen.probability});
    }
    return said;
  };
  EXPECT_EQ(run(), run());
}

TEST(Watcher, PictureOfAnotherSizeIsRefusedAndForgotten) {
  Table table;
  table.put("Cup", 0, 0);
  ASSERT_EQ(table.look(2).size(), 1u);
  Watcher watcher(Detector(trained(), catalogue()));
  EXPECT_FALSE(watcher.look(Time(), Picture(320, 240), lab_camera()));
  EXPECT_FALSE(watcher.look(Time(), Picture(), lab_camera()));
  EXPECT_TRUE(watcher.look(Time(), Picture(640, 480), lab_camera())->empty());
  // A camera that changes its resolution brings another calibration along; the rest goes on.
  EXPECT_TRUE(watcher.look(Time(), Picture(320, 240), lab_camera().scaled(0.5))->empty());
}

}  // namespace
}  // namespace prehend::recognition
