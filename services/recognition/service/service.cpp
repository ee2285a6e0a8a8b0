#include "services/recognition/service/service.hpp"

#include <fmt/format.h>

#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

#include "common/base/clock.hpp"
#include "common/base/log.hpp"
#include "common/base/log_format.hpp"
#include "common/convert/convert.hpp"
#include "common/dds/topics.hpp"
#include "common/ros2/nodes/nodes.hpp"
#include "services/recognition/cameras/camera.hpp"
#include "services/recognition/core/detection/detector.hpp"
#include "services/recognition/core/detection/watcher.hpp"
#include "services/recognition/files/model_file.hpp"
#include "services/recognition/files/picture_file.hpp"

namespace prehend::recognition {
namespace {

using Clock = std::chrono::steady_clock;

/// Pictures are worked on at this width at most; more costs time and finds nothing more.
constexpr int max_side = 640;
/// What is less likely than this share of what is accepted no grasp raises.
constexpr double min_doubtful = 0.6;

}  // namespace

/// Reads a camera in a thread of its own and hands over the newest picture only.
class Service::CameraThread {
 public:
  using Take = std::function<void(Picture, Time)>;

  CameraThread(std::unique_ptr<Camera> camera, double rate, service::Shell& shell, Take take)
      : camera_(std::move(camera)),
        period_(seconds(1 / rate)),
        shell_(shell),
        take_(std::move(take)),
        thread_([this](std::stop_token stop) { run(stop); }) {}

 private:
  void run(const std::stop_token& stop) {
    Clock::time_point due = Clock::now();
    while (!stop.stop_requested()) {
      if (!camera_->paces_itself() && !sleep_until(stop, due)) return;
      auto picture = camera_->next();
      const Time stamp = process_now();
      const Clock::time_point now = Clock::now();
      if (!picture) {
        complain(picture.error());
        if (camera_->finished()) return;
        due = Clock::now() + std::chrono::milliseconds(300);
        if (!sleep_until(stop, due)) return;
        continue;
      }
      if (!said_.empty()) {
        log::info("the camera gives pictures again");
        said_.clear();
        shell_.status().running();
      }
      // A tenth of a period early is in time: a camera of the same rate must not lose every other.
      if (camera_->paces_itself() && now < due - period_ / 10) continue;
      due = std::max<Clock::time_point>(due + period_, now - period_);
      hand_over(std::move(*picture), stamp - camera_->age());
    }
  }

  void hand_over(Picture picture, Time stamp) {
    {
      const std::lock_guard lock(mutex_);
      const bool waiting = newest_.has_value();
      newest_ = {std::move(picture), stamp};
      if (waiting) {
        shell_.status().drop("picture overtaken by a newer one");
        return;
      }
    }
    shell_.post([this] {
      std::optional<std::pair<Picture, Time>> taken;
      {
        const std::lock_guard lock(mutex_);
        taken.swap(newest_);
      }
      if (taken) take_(std::move(taken->first), taken->second);
    });
  }

  void complain(const Error& error) {
    shell_.status().drop(error.what);
    shell_.status().degraded(error.message());
    if (said_ != error.what) log::warning(error);
    said_ = error.what;
  }

  /// False when it is time to stop.
  bool sleep_until(const std::stop_token& stop, Clock::time_point time) {
    std::unique_lock lock(mutex_);
    sleeper_.wait_until(lock, stop, time, [] { return false; });
    return !stop.stop_requested();
  }

  std::unique_ptr<Camera> camera_;
  Duration period_;
  service::Shell& shell_;
  Take take_;
  std::string said_;
  std::mutex mutex_;
  std::condition_variable_any sleeper_;
  std::optional<std::pair<Picture, Time>> newest_;
  std::jthread thread_;  // last: it uses all of the above
};

/// The topics' side of Watcher. Lives as long as the shell runs.
class Service::Topics {
 public:
  /// `preview`: a jpeg that shows the last picture with what was recognised; empty: none.
  Topics(service::Shell& shell, Detector detector, const CameraModel& camera,
         model::GraspTaxonomy taxonomy, bool publishes, std::filesystem::path preview)
      : shell_(shell),
        taxonomy_(std::move(taxonomy)),
        watcher_(std::move(detector)),
        camera_(camera),
        name_(shell.config().text("camera.name")),
        preview_(std::move(preview)),
        output_(shell.publish(dds::object_detection)) {
    if (publishes) images_ = shell.publish(dds::camera_image);
    shell.subscribe(
        dds::demonstration_grasp,
        std::function([this](const v1::DemonstratedGrasp& grasp, const dds::SampleInfo& info) {
          if (!info.gone) on_grasp(grasp);
        }));
    shell.on_tick(std::chrono::milliseconds(50), [this](Time now) { dispose_gone(now); });
  }

  /// Pictures come by topic.
  void listen() {
    shell_.subscribe(dds::camera_image, std::function([this](const v1::CameraImage& image,
                                                             const dds::SampleInfo& info) {
                       if (info.gone) return;
                       if (image.camera().to_string() == name_)
                         on_image(image);
                       else
                         shell_.status().drop("picture of another camera");
                     }));
  }

  /// A picture of our own camera: published, and seen as everyone else sees it, so that a recording
  /// of the topic gives the same answers.
  void on_picture(const Picture& picture, Time stamp) {
    v1::CameraImage image;
    image.camera(name_);
    image.sequence_number(number_);
    image.stamp_ns(to_ns(stamp));
    image.width(picture.width);
    image.height(picture.height);
    image.encoding("jpeg");
    image.calibration(name_);
    image.data(encode_jpeg(picture));
    images_->publish(image);
    on_image(image);
    ++number_;
  }

  void on_image(const v1::CameraImage& image) {
    const auto begin = std::chrono::steady_clock::now();
    auto picture = decode_picture(image.data(), "camera/image");
    if (!picture) return refuse("unreadable picture", picture.error());
    const Picture small = shrink(*picture, max_side);
    const double factor = static_cast<double>(small.width) / camera_.width;
    if (std::abs(camera_.height * factor - small.height) > 1.01)
      return refuse("picture of another format than the calibration",
                    {"a picture has " + std::to_string(picture->width) + "x" +
                         std::to_string(picture->height) + " px",
                     "camera",
                     "its sides must be in the ratio of camera.width and camera.height: set these, "
                     "or the camera"});
    CameraModel camera = camera_.scaled(factor);
    camera.height = small.height;
    const Time stamp = from_ns(image.stamp_ns());
    const auto tracks = watcher_.look(stamp, small, camera);
    if (!tracks) return refuse("picture that cannot be used", tracks.error());
    if (const int times = watcher_.movement().relearned(); times > relearned_) {
      shell_.status().count("background learned anew",
                            static_cast<std::uint64_t>(times - relearned_));
      relearned_ = times;
    }
    if (!said_.empty()) shell_.status().running();
    said_.clear();
    const double larger = static_cast<double>(picture->width) / small.width;
    for (const Track& track : *tracks) publish(track, larger, stamp, image.sequence_number());
    if (!preview_.empty()) show(*tracks, small);
    shell_.status().count("pictures");
    shell_.status().latency(
        "picture", std::chrono::duration_cast<Duration>(std::chrono::steady_clock::now() - begin));
  }

 private:
  /// Of an object that is known already the hand says nothing new: its kinds of grasps were weighed
  /// by that object.
  void on_grasp(const v1::DemonstratedGrasp& message) {
    if (!message.object().to_string().empty()) return;
    SeenGrasp grasp{from_ns(message.stamp_ns()),
                    std::vector<double>(taxonomy_.classes().size(), 0.0)};
    for (const v1::GraspProbability& each : message.grasps()) {
      const model::GraspClass* kind = taxonomy_.find(each.grasp().to_string());
      const double p = each.probability();
      if (!(p >= 0 && p <= 1)) return shell_.status().drop("grasp whose probability is none");
      if (kind) grasp.p[static_cast<std::size_t>(kind - taxonomy_.classes().data())] = p;
    }
    watcher_.told(taxonomy_, std::move(grasp));
  }

  /// `larger`: the published picture is than the one that was looked at.
  void publish(const Track& track, double larger, Time stamp, std::uint64_t number) {
    v1::ObjectDetection message;
    message.track(track.id);
    message.sequence_number(number);
    message.stamp_ns(to_ns(stamp));
    message.name(track.seen.name);
    message.shape(convert::to_message(track.seen.shape.kind));
    message.size(convert::to_message(track.seen.shape.size));
    message.X_WO(convert::to_message(standing_pose(track.seen.shape, *track.seen.at)));
    // x, y, z, yaw: the height is known from the table, give or take a millimetre.
    Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
    constexpr std::array<int, 3> place{0, 1, 3};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        covariance(place[static_cast<std::size_t>(i)], place[static_cast<std::size_t>(j)]) =
            track.seen.covariance(i, j);
    covariance(2, 2) = 1e-6;
    for (int i = 0; i < 16; ++i)
      message.covariance()[static_cast<std::size_t>(i)] = covariance(i / 4, i % 4);
    message.probability(track.seen.probability);
    message.moving(track.moving);
    message.box().x(larger * track.seen.box.x);
    message.box().y(larger * track.seen.box.y);
    message.box().width(larger * track.seen.box.width);
    message.box().height(larger * track.seen.box.height);
    output_.publish(message);
    shell_.status().count("detections");
  }

  /// Beside it first: a viewer never sees half a file.
  void show(const std::vector<Track>& tracks, Picture picture) {
    for (const Track& track : tracks) {
      const Box& box = track.seen.box;
      draw_frame(picture, box.x, box.y, box.width, box.height,
                 fmt::format("{} {:.0f} %{}", track.seen.name, 100 * track.seen.probability,
                             track.moving ? ", moving" : ""));
    }
    const std::filesystem::path beside = preview_.string() + ".new";
    std::error_code error;
    if (const auto saved = save_jpeg(beside, picture); saved)
      std::filesystem::rename(beside, preview_, error);
    else
      error = std::make_error_code(std::errc::io_error);
    if (error) shell_.status().drop("preview that could not be written");
  }

  void dispose_gone(Time now) {
    for (const std::uint32_t id : watcher_.expire(now)) {
      v1::ObjectDetection key;
      key.track(id);
      output_.dispose(key);
    }
  }

  void refuse(const std::string& reason, const Error& error) {
    shell_.status().drop(reason);
    shell_.status().degraded(error.message());
    if (said_ != reason) log::warning(error);
    said_ = reason;
  }

  service::Shell& shell_;
  model::GraspTaxonomy taxonomy_;
  Watcher watcher_;
  CameraModel camera_;
  std::string name_;
  std::filesystem::path preview_;
  service::Shell::Output<v1::ObjectDetection> output_;
  std::optional<service::Shell::Output<v1::CameraImage>> images_;
  std::uint64_t number_ = 0;
  int relearned_ = 0;
  std::string said_;
};

Service::Service(std::unique_ptr<Topics> topics) : topics_(std::move(topics)) {}
Service::~Service() = default;

namespace {

struct Parts {
  CameraModel camera;
  model::Catalogue catalogue;
  std::optional<model::Scene> scene;
  Detector detector;
};

Expected<Parts> load(const service::Config& config) {
  auto camera = configured_camera(config);
  if (!camera) return tl::unexpected(camera.error());
  auto catalogue = model::Catalogue::load(config.path("lab.catalogue"));
  if (!catalogue) return tl::unexpected(catalogue.error());
  auto models = load_models(config.path("recognition.model"));
  if (!models) return tl::unexpected(models.error());
  std::optional<model::Scene> scene;
  if (const auto file = config.path("lab.scene"); !file.empty()) {
    auto loaded = model::load_scene(file, *catalogue);
    if (!loaded) return tl::unexpected(loaded.error());
    scene = std::move(*loaded);
  }
  DetectorOptions options;
  options.accept = config.number("recognition.accept");
  options.doubtful = min_doubtful * options.accept;
  Detector detector(std::move(*models), *catalogue, options);
  return Parts{*camera, std::move(*catalogue), std::move(scene), std::move(detector)};
}

Expected<std::unique_ptr<Camera>> open_configured(const service::Config& config,
                                                  const CameraKind& source, const Parts& parts,
                                                  double rate) {
  CameraOptions wanted{std::string(source.name), config.text("recognition.path"), parts.camera,
                       rate};
  if (source.line == CameraLine::nodes) {
    const auto network =
        ros2::network_of_leaders(config.text("ros.network"), !config.path("lab.keys").empty());
    if (!network) return tl::unexpected(network.error());
    wanted.network = *network;
  }
  const bool is_file =
      source.line == CameraLine::stream && wanted.path.find("://") == std::string::npos;
  if (source.line == CameraLine::folder || is_file)
    wanted.path = config.path("recognition.path").string();
  return open_camera(wanted, parts.catalogue, parts.scene ? &*parts.scene : nullptr);
}

}  // namespace

Expected<std::unique_ptr<Service>> Service::create(service::Shell& shell) {
  const service::Config& config = shell.config();
  auto parts = load(config);
  if (!parts) return tl::unexpected(parts.error());
  auto taxonomy = model::GraspTaxonomy::of_the_house();
  if (!taxonomy) return tl::unexpected(taxonomy.error());
  const double rate = config.number("recognition.rate");
  if (!(rate > 0 && rate <= 200))
    return fail("must lie in 0 to 200 Hz", "recognition.rate", "10 is usual");
  const auto source = find_camera(config.text("recognition.source"));
  if (!source) return tl::unexpected(source.error());
  const bool by_topic = source->line == CameraLine::topic;
  if (!by_topic && shell.lockstep())
    return fail("in lockstep pictures come by topic only", "recognition.source",
                fmt::format("set recognition.source={}", topic_camera().name));
  std::unique_ptr<Camera> camera;
  if (!by_topic) {
    auto opened = open_configured(config, *source, *parts, rate);
    if (!opened) return tl::unexpected(opened.error());
    camera = std::move(*opened);
  }
  std::unique_ptr<Service> made(new Service(std::make_unique<Topics>(
      shell, std::move(parts->detector), parts->camera, std::move(*taxonomy), !by_topic,
      config.path("recognition.preview"))));
  Topics* const topics = made->topics_.get();
  if (by_topic)
    topics->listen();
  else
    made->camera_ = std::make_unique<CameraThread>(
        std::move(camera), rate, shell,
        [topics](const Picture& picture, Time stamp) { topics->on_picture(picture, stamp); });
  shell.status().running();
  return made;
}

}  // namespace prehend::recognition
