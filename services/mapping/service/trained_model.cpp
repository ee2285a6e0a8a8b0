#include "services/mapping/service/trained_model.hpp"

#include "common/stage/first_training.hpp"
#include "services/mapping/files/mapping_model_file.hpp"
#include "services/mapping/files/model_places.hpp"

namespace prehend::mapping {

Expected<MappingModel> trained_model(const std::string& hand, const model::HandModel& model,
                                     const std::function<bool()>& stopped) {
  const auto load = [&] {
    const ModelPlaces places = model_places(hand);
    return load_mapping_model(places.model, model, places.made_for);
  };
  auto found = load();
  if (found) return found;
  return stage::train_if_needed(hand, stopped).and_then(load);
}

}  // namespace prehend::mapping
