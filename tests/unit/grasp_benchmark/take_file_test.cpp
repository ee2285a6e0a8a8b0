// Takes of the benchmark as files, and recordings of people: what is none is refused by name.
#include "services/mapping/tools/benchmark/take_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <functional>

#include "common/base/file_text.hpp"
#include "common/proto/benchmark_take.pb.h"
#include "common/proto/sealed_file.hpp"
#include "common/recording/mcap/reader.hpp"
#include "common/recording/mcap/writer.hpp"
#include "services/mapping/tools/benchmark/people.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::mapping {
namespace {

namespace fs = std::filesystem;
namespace mcap = recording::mcap;
using testing::HasSubstr;

class TakeFiles : public testing::Test {
 protected:
  TakeFiles()
      : folder_(fs::path(testing::TempDir()) / ("takes" + std::to_string(getpid()))),
        hand_(model::HandModel::load(test::in_sources("common/models/hands/barrett")).value()) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    const auto grasps = load_robot_grasps(test::in_share("trained/barrett.grasps"), hand_).value();
    for (int number = 0; take_.recorded.postures.empty(); ++number)
      if (auto made = make_take(grasps, {}, number)) take_ = std::move(*made);
  }
  ~TakeFiles() override { fs::remove_all(folder_); }

  void save(const char* name) { ASSERT_TRUE(save_take(folder_ / name, hand_, take_)); }

  /// What is said of the take after its description was spoilt and sealed again; no topics are
  /// beside it.
  std::string refusal(const std::function<void(messages::BenchmarkTake&)>& spoil) {
    save("good.take");
    const auto reader = mcap::Reader::open(folder_ / "good.take").value();
    mcap::Bytes buffer;
    auto attachment = reader.attachment(reader.contents().attachments.front(), buffer).value();
    messages::BenchmarkTake message;
    EXPECT_TRUE(message.ParseFromString(
        proto::unseal(mcap::text(attachment.data), "benchmark-take").value()));
    spoil(message);
    const std::string sealed = proto::seal("benchmark-take", message.SerializeAsString());
    attachment.data = mcap::view(sealed);
    auto writer = mcap::Writer::create(folder_ / "odd.take").value();
    EXPECT_TRUE(writer.write(attachment));
    EXPECT_TRUE(writer.close());
    const auto made = load_take(folder_ / "odd.take", hand_);
    return made ? "taken" : made.error().message();
  }

  fs::path folder_;
  model::HandModel hand_;
  BenchmarkTake take_;
};

TEST_F(TakeFiles, SayWhatTheyLack) {
  EXPECT_THAT(refusal([](auto&) {}), HasSubstr("odd.take: has no usable hand/posture"));
  using Message = messages::BenchmarkTake;
  for (const auto& spoil : std::initializer_list<std::function<void(Message&)>>{
           [](Message& take) { take.clear_seen_size(); },
           [](Message& take) { take.set_seen_shape("teapot"); },
           [](Message& take) { take.set_covariance(5, std::nan("")); }})
    EXPECT_THAT(refusal(spoil),
                HasSubstr("odd.take: describes no take (write it again: prehend benchmark"));
}

TEST_F(TakeFiles, NeedTheirTypesInTheShare) {
  fs::create_directories(folder_ / "idl");
  for (const char* file : {"Geometry.idl", "Perception.idl"})
    fs::copy(fs::path(test::in_share("idl")) / file, folder_ / "idl");
  ::setenv("PREHEND_SHARE", folder_.c_str(), 1);
  const auto saved = save_take(folder_ / "a.mcap", hand_, take_);
  ::unsetenv("PREHEND_SHARE");
  EXPECT_THAT(saved.error().message(),
              HasSubstr("HandPosture: is not in share/prehend/idl (is all of it installed?)"));
}

TEST_F(TakeFiles, OfAFolderAreSomeAndEachOnce) {
  EXPECT_EQ(load_takes(folder_, hand_).error().message(),
            folder_.string() + ": holds no takes (prehend benchmark --export writes some)");
  save("a.mcap");
  EXPECT_EQ(load_takes(folder_, hand_)->size(), 1u);
  save("b.mcap");
  EXPECT_EQ(load_takes(folder_, hand_).error().message(),
            folder_.string() + ": holds take " + std::to_string(take_.number) + " twice");
}

TEST_F(TakeFiles, OfPeopleSayWhyNoneCanBeUsed) {
  ASSERT_TRUE(write_file(folder_ / "z.txt", "notes"));
  EXPECT_THAT(load_people(folder_).error().message(),
              testing::MatchesRegex(".*: none of its 1 files is a usable recording of a right hand "
                                    ".*z.txt: is no recording.*"));
  for (Posture& posture : take_.recorded.postures)
    for (auto& tip : posture.fingertips) tip.valid = false;
  save("a.mcap");
  EXPECT_THAT(
      load_people(folder_).error().message(),
      testing::MatchesRegex(".*: none of its 2 files .*a.mcap: has no usable hand/posture.*"));
}

}  // namespace
}  // namespace prehend::mapping
