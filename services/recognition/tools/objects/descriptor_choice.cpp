#include "services/recognition/tools/objects/descriptor_choice.hpp"

#include <CLI/CLI.hpp>

namespace prehend::recognition {

void DescriptorChoice::add_to(CLI::App& command) {
  command
      .add_option("--for", purpose_,
                  "table: objects cut out by masks, found on a table; photos: photos of single "
                  "objects. Else table where masks lie beside the pictures")
      ->check(CLI::IsMember({"table", "photos"}));
  command.add_option("--colour-space", colour_space_)
      ->check(CLI::IsMember({"chromaticity", "lab"}));
  command.add_option("--brightness", brightness_, "weight of brightness beside colour")
      ->check(CLI::Range(0.0, 10.0));
  command.add_option("--constancy", constancy_, "what is done about the colour of the light")
      ->check(CLI::IsMember({"none", "grey-world", "shades-of-grey"}));
  command.add_option("--colours", colours_, "of the palette")
      ->check(CLI::Range(2, Palette::max_colours));
  command
      .add_option("--distances", distances_,
                  "between the pixels of a pair, px; 0 is the plain histogram")
      ->delimiter(',')
      ->check(CLI::Range(0, 64));
  command.add_option("--same-pairs", same_pairs_, "weight of pairs of one colour")
      ->check(CLI::Range(0.0, 1.0));
  command.add_option("--weighting", weighting_, "how histograms are compared")
      ->check(CLI::IsMember({"idf-hellinger", "hellinger", "intersection"}));
  command.add_option("--varied", varied_, "copies of each view under another light, size, place")
      ->check(CLI::Range(0, 20));
  command.add_option("--parts", parts_, "copies of each view of which a part is hidden")
      ->check(CLI::Range(0, 20));
}

Expected<DescriptorOptions> DescriptorChoice::options(const Dataset& dataset) const {
  DescriptorOptions made = suited_options(dataset);
  if (!purpose_.empty()) made = purpose_ == "table" ? DescriptorOptions{} : photos_of_objects();
  if (colour_space_ == "lab") made.space.colours = Colours::lab;
  if (colour_space_ == "chromaticity") made.space.colours = Colours::chromaticity;
  if (constancy_ == "none") made.space.constancy = Constancy::none;
  if (constancy_ == "grey-world") made.space.constancy = Constancy::grey_world;
  if (constancy_ == "shades-of-grey") made.space.constancy = Constancy::shades_of_grey;
  if (weighting_ == "idf-hellinger") made.weighting = Weighting::idf_hellinger;
  if (weighting_ == "hellinger") made.weighting = Weighting::hellinger;
  if (weighting_ == "intersection") made.weighting = Weighting::intersection;
  made.space.brightness_weight = brightness_.value_or(made.space.brightness_weight);
  made.colours = colours_.value_or(made.colours);
  made.varied = varied_.value_or(made.varied);
  made.parts = parts_.value_or(made.parts);
  made.same_pairs = same_pairs_.value_or(made.same_pairs);
  if (!distances_.empty()) made.distances = distances_;
  if (made.distances.size() > 16)
    return fail("more than 16 distances", "--distances", "name fewer");
  return made;
}

}  // namespace prehend::recognition
