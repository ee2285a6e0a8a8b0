// `prehend objects` as a user calls it: what is missing or wrong is named before anybody turns an
// object, and what was not seen afterwards.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/recognition/files/model_file.hpp"
#include "services/recognition/files/picture_file.hpp"
#include "tests/support/command_test.hpp"
#include "tests/support/paths/paths.hpp"
#include "tests/unit/recognition_learning/painted.hpp"

namespace prehend::recognition {
namespace {

using Refusals = std::vector<std::pair<std::string, std::string>>;

class ObjectsCommand : public test::CommandTest {
 protected:
  ObjectsCommand() : CommandTest(test::in_programs("prehend-objects")) {}
  void expect(const Refusals& refusals) {
    for (const auto& [arguments, says] : refusals) {
      const auto answer = run(arguments);
      EXPECT_NE(answer.code, 0) << arguments;
      EXPECT_THAT(answer.complaint, testing::HasSubstr(says)) << arguments;
    }
  }
};

TEST_F(ObjectsCommand, AddSaysWhatShapeItNeeds) {
  // A tetrahedron, in millimetres.
  const std::string mesh =
      "add A --mesh " + file("mm.obj",
                             "v 0 0 0\nv 40 0 0\nv 0 40 0\nv 0 0 60\nf 1 3 2\nf 1 2 4\nf 1 4 3\n"
                             "f 2 3 4\n");
  expect({{"add A", "A: needs a shape (--shape "},
          {"add A --shape cube", "cube: is no shape ("},
          {"add A --shape box", "A: needs a size (--size, in m: depth, length, height)"},
          {"add A --shape box --size 0.1",
           "box: has no such size (give --size in metres, above 0 and up to 2: depth, le"},
          {"add A --shape sphere --size 3",
           "sphere: has no such size (give --size in metres, above 0 and up to 2: radius)"},
          {mesh + " --scale 0.1",
           "mm.obj: is 4000 x 4000 x 6000 mm large (--scale says how many metres"},
          {mesh + " --scale 0.001 --shape box",
           "A: has its shape and size from its mesh (leave out"}});
}

// An empty table, an object that rests there, and a picture that cannot be read: one view.
TEST_F(ObjectsCommand, AddSaysHowLittleWasSeen) {
  const auto models = train(painted_classes(1, 1));
  ASSERT_TRUE(models);
  ASSERT_TRUE(save_models(in("objects.model"), *models));
  std::filesystem::create_directory(in("shots"));
  Random random(1);
  for (int i = 10; i < 32; ++i) {
    Picture shot(160, 120);
    for (auto& value : shot.rgb) value = static_cast<std::uint8_t>(120 + random.index(5));
    for (int y = 40; i >= 22 && y < 80; ++y)
      for (int x = 60; x < 100; ++x) shot.at(x, y)[0] = shot.at(x, y)[2] = 20;
    ASSERT_TRUE(save_png(in("shots/" + std::to_string(i) + ".png"), shot));
  }
  file("shots/99.png", "no picture");
  const std::string add =
      "add A --shape sphere --size 0.03 --model " + in("objects.model") + " --source ";
  expect({{add + "synthetic", "synthetic: shows one scene only (give "},
          {add + "folder:" + in("shots"), "A: 1 of at least 3 views ("}});
}

TEST_F(ObjectsCommand, EvaluateSaysWhatItCannotUse) {
  std::filesystem::create_directories(in("bad/one"));
  file("bad/one/1.png", "no picture");
  std::filesystem::create_directories(in("good/one"));
  ASSERT_TRUE(save_png(in("good/one/1.png"), painted_classes(1, 1)[0].views[0].picture));
  expect({{"evaluate " + in("bad"), "bad: no picture could be read (jpeg, png, bmp,"},
          {"evaluate " + in("good") + " --distances 0,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16",
           "--distances: more than 16 distances (name fewer)"}});
}

}  // namespace
}  // namespace prehend::recognition
