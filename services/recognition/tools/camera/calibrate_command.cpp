// `prehend camera calibrate`.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <optional>

#include "common/base/finite_number.hpp"
#include "common/base/log.hpp"
#include "common/base/progress.hpp"
#include "common/base/toml_text.hpp"
#include "common/service/arguments.hpp"
#include "services/recognition/cameras/camera.hpp"
#include "services/recognition/files/picture_file.hpp"
#include "services/recognition/service/service.hpp"
#include "services/recognition/tools/calibration/board_taker.hpp"
#include "services/recognition/tools/camera/commands.hpp"

namespace prehend::recognition {
namespace {

struct Arguments {
  service::LabArguments lab;
  std::string source, only, table, place = "0,0,0";
  Chessboard board;
  int views = 20;
  double limit = 300, worst = 1;
  bool write = false, json = false;
};

struct Seen {
  std::vector<BoardView> views;
  std::vector<std::string> names;     // of the pictures with a view
  std::vector<std::string> left_out;  // those that show no board or cannot be read
  std::optional<BoardView> table;     // of the board lying on the table
  std::string table_name;             // of its picture
  int width = 0, height = 0, pictures = 0;
};

/// The same failure, of a program that ends with this code.
tl::unexpected<Error> told(Error error, Exit exit) {
  error.exit = exit;
  return tl::unexpected<Error>(std::move(error));
}

Expected<TablePose> lying_at(const std::string& text) {
  const auto numbers = finite_list(text);
  if (!numbers || numbers->size() != 3) return fail("is not X,Y,YAW in m and rad", text);
  return TablePose{(*numbers)[0], (*numbers)[1], (*numbers)[2]};
}

Expected<void> add(Seen& seen, const Picture& picture, const std::string& name) {
  if (seen.pictures++ == 0) {
    seen.width = picture.width;
    seen.height = picture.height;
  }
  if (picture.width == seen.width && picture.height == seen.height) return {};
  return fail(fmt::format("has {}x{} px, those before {}x{}", picture.width, picture.height,
                          seen.width, seen.height),
              name, "all pictures of a calibration must have one size");
}

constexpr const char* choose_another =
    "the board must lie on the table, wholly in sight; --table-picture FILE chooses another";

/// Sees the board on the table in this picture, or says why not: another picture in its stead would
/// place the camera elsewhere.
Expected<void> add_table(Seen& seen, const Expected<Picture>& picture, const std::string& name,
                         const Chessboard& board) {
  if (!picture)
    return fail("is the table's picture: " + picture.error().what, name, choose_another);
  if (const auto good = add(seen, *picture, name); !good) return good;
  seen.table = find_chessboard(*picture, board);
  seen.table_name = name;
  if (seen.table) return {};
  return fail("is the table's picture and shows no board", name, choose_another, exit_no);
}

/// The picture that was chosen for the table, by its path or by its name in the folder; else the
/// first. Empty when the table is not asked for.
std::filesystem::path table_picture(const Arguments& arguments, const std::filesystem::path& folder,
                                    const std::vector<std::filesystem::path>& files) {
  if (arguments.only == "intrinsics") return {};
  if (arguments.table.empty()) return files.front();
  std::error_code error;
  const auto within = folder / arguments.table;
  return std::filesystem::exists(within, error) ? within : std::filesystem::path(arguments.table);
}

Expected<Seen> in_folder(const Arguments& arguments, const std::filesystem::path& folder) {
  const auto files = pictures_in(folder);
  if (files.empty()) return fail("has no picture", folder.string(), "jpg, png, ...");
  Seen seen;
  Progress progress("pictures");
  const auto table = table_picture(arguments, folder, files);
  if (!table.empty())
    if (const auto good = add_table(seen, load_picture(table), table.string(), arguments.board);
        !good)
      return tl::unexpected(good.error());
  std::error_code same;
  for (const auto& file : files) {
    const std::string name = file.filename().string();
    if (!table.empty() && std::filesystem::equivalent(file, table, same)) {
      seen.views.push_back(*seen.table);
      seen.names.push_back(name);
      continue;
    }
    const auto picture = load_picture(file);
    if (picture)
      if (const auto good = add(seen, *picture, file.string()); !good)
        return tl::unexpected(good.error());
    auto view = picture ? find_chessboard(*picture, arguments.board) : std::nullopt;
    if (view) {
      seen.views.push_back(std::move(*view));
      seen.names.push_back(name);
    } else {
      seen.left_out.push_back(name);
      log::warning("left out: {}",
                   picture ? file.string() + ": shows no board" : picture.error().message());
    }
    progress.show(static_cast<std::size_t>(seen.pictures), files.size());
  }
  return seen;
}

Expected<Seen> from_camera(const Arguments& arguments, const CameraOptions& wanted) {
  auto camera = open_camera(wanted, model::Catalogue(), nullptr);
  if (!camera) return tl::unexpected(camera.error());
  BoardTaker taker(arguments.board, arguments.only == "place" ? 1 : arguments.views);
  Seen seen;
  std::string said;
  const auto begin = std::chrono::steady_clock::now();
  while (!taker.done()) {
    if (taker.hint() != said) log::info("{}", said = taker.hint());
    const auto picture = (*camera)->next();
    if (!picture && (*camera)->finished()) break;
    if (std::chrono::steady_clock::now() - begin > std::chrono::duration<double>(arguments.limit))
      return fail(fmt::format("only {} of {} views within {:.0f} s", taker.views().size(),
                              arguments.views, arguments.limit),
                  "calibration", taker.hint());
    if (!picture) return tl::unexpected(picture.error());
    if (const auto good = add(seen, *picture, wanted.path); !good)
      return tl::unexpected(good.error());
    if (!taker.see(*picture)) continue;
    seen.names.push_back(fmt::format("view {}", taker.views().size()));
    log::info("{} of {} taken", taker.views().size(), arguments.views);
  }
  seen.views = taker.views();
  if (arguments.only == "intrinsics") return seen;
  if (!arguments.table.empty()) {
    const auto good =
        add_table(seen, load_picture(arguments.table), arguments.table, arguments.board);
    if (!good) return tl::unexpected(good.error());
  } else if (!seen.views.empty()) {
    seen.table = seen.views.front();
    seen.table_name = seen.names.front();
  }
  return seen;
}

Expected<Seen> look(const Arguments& arguments, const CameraModel& camera) {
  const auto [name, path] = camera_source(arguments.source);
  const auto kind = find_camera(name);
  const auto line = kind ? kind->line : CameraLine::none;
  if (line == CameraLine::device || line == CameraLine::nodes ||
      (line == CameraLine::stream && !path.empty()))
    return from_camera(arguments, {name, path, camera, 10});
  return in_folder(arguments, line == CameraLine::folder ? path : arguments.source);
}

nlohmann::ordered_json to_json(const CameraModel& camera) {
  const Eigen::Vector3d p = camera.X_WC.translation();
  const Eigen::Quaterniond q(camera.X_WC.linear());
  return {{"width", camera.width},
          {"height", camera.height},
          {"focal", {camera.focal.x(), camera.focal.y()}},
          {"centre", {camera.centre.x(), camera.centre.y()}},
          {"distortion", camera.distortion},
          {"X_WC", {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()}}};
}

/// The lens, from all views. True: exact enough.
Expected<bool> calibrate_lens(const Arguments& arguments, const Seen& seen, const Chessboard& board,
                              CameraModel& camera, nlohmann::ordered_json& report) {
  const auto made = calibrate(seen.views, board, seen.width, seen.height);
  if (!made) return told(made.error(), exit_no);
  const Pose X_WC = camera.X_WC;
  camera = made->camera;
  camera.X_WC = X_WC;
  for (std::size_t i = 0; i < made->errors.size(); ++i) {
    if (made->errors[i] < 0)
      log::warning("{} was left out: it does not fit the others", seen.names[i]);
  }
  log::info("residual {:.2f} px; focal length ± {:.1f} px, principal point ± {:.1f} px",
            made->residual, made->focal_sigma.maxCoeff(), made->centre_sigma.maxCoeff());
  if (made->covered < 0.7)
    log::warning(
        "corners were seen in {:.0f} % of the picture only: distortion at its rim is a "
        "guess",
        100 * made->covered);
  report["residual_px"] = made->residual;
  report["focal_sigma_px"] = made->focal_sigma.maxCoeff();
  report["covered"] = made->covered;
  return made->residual <= arguments.worst;
}

/// Where the camera is, from the view that shows the board lying on the table.
Expected<bool> calibrate_place(const Arguments& arguments, const Seen& seen,
                               const Chessboard& board, const TablePose& lying, CameraModel& camera,
                               nlohmann::ordered_json& report) {
  if (!seen.table)
    return told(
        {"shows no board", "the first picture", "the board must lie on the table, wholly in sight"},
        exit_no);
  if (camera.width != seen.width || camera.height != seen.height)
    return told({fmt::format("has {}x{} px, the configured lens {}x{}", seen.width, seen.height,
                             camera.width, camera.height),
                 seen.table_name, "calibrate the lens, too: without --only place"},
                exit_wrong_use);
  const auto place = locate_camera(camera, *seen.table, board, lying);
  if (!place) return told(place.error(), exit_no);
  log::info("the board lies on the table in {}", seen.table_name);
  report["table_picture"] = seen.table_name;
  camera.X_WC = place->X_WC;
  log::info("place: residual {:.2f} px, {:.1f} mm on the table", place->residual,
            1000 * place->on_table);
  report["place_residual_px"] = place->residual;
  report["place_residual_m"] = place->on_table;
  return place->residual <= arguments.worst;
}

int calibrate_with(const Arguments& arguments) {
  const auto config = arguments.lab.load();
  if (!config) return service::complain(config.error(), exit_wrong_use);
  const auto board = checked_board(arguments.board);
  if (!board) return service::complain(board.error(), exit_wrong_use);
  const auto lying = lying_at(arguments.place);
  if (!lying) return service::complain(lying.error(), exit_wrong_use);
  auto camera = configured_camera(*config);
  if (!camera) return service::complain(camera.error(), exit_broken);
  const auto seen = look(arguments, *camera);
  if (!seen) return service::complain(seen.error());
  log::info("the board is in sight in {} of {} pictures", seen->views.size(), seen->pictures);

  nlohmann::ordered_json report;
  Expected<bool> lens = true, place = true;
  if (arguments.only != "place") lens = calibrate_lens(arguments, *seen, *board, *camera, report);
  if (!lens) return service::complain(lens.error());
  if (arguments.only != "intrinsics")
    place = calibrate_place(arguments, *seen, *board, *lying, *camera, report);
  if (!place) return service::complain(place.error());
  const bool good = *lens && *place;
  if (!good)
    log::error(
        "the residual is above {} px: is the board flat, its measures right, the camera in "
        "focus and without zoom?",
        arguments.worst);
  const auto lines = camera_lines(*camera);
  if (good && arguments.write) {
    for (const auto& [key, line] : lines)
      if (const auto written = write_line(arguments.lab.file(), "camera", key, line); !written)
        return service::complain(written.error(), exit_broken);
    log::info("written to {}", arguments.lab.file());
  }
  if (arguments.json) {
    report["camera"] = to_json(*camera);
    report["views"] = seen->views.size();
    report["left_out"] = seen->left_out;
    std::cout << report.dump() << '\n';
  } else {
    std::cout << "[camera]\n";
    for (const auto& [key, line] : lines) std::cout << line << '\n';
  }
  return good ? exit_done : exit_no;
}

}  // namespace

void add_calibrate(tool::Program& program) {
  auto* command = program.app().add_subcommand(
      "calibrate", "Finds a camera's lens and place from pictures of a chessboard.");
  const auto a = std::make_shared<Arguments>();
  a->lab.add_to(*command);
  command
      ->add_option(
          "source", a->source,
          "a folder of pictures, or " +
              camera_words({CameraLine::device, CameraLine::stream, CameraLine::nodes}) +
              "; the first picture (shot2 comes before shot10) shows the board lying on the table")
      ->required();
  command->add_option("--columns", a->board.columns, "inner corners in a row")
      ->capture_default_str();
  command->add_option("--rows", a->board.rows, "inner corners in a column")->capture_default_str();
  command->add_option("--square", a->board.square, "m, side of a square")->capture_default_str();
  command
      ->add_option("--place", a->place,
                   "X,Y,YAW: where the first inner corner lies on the table (m), and the turn of "
                   "the rows (rad); the first corner is that beside the dark corner square")
      ->capture_default_str();
  command->add_option("--table-picture,--table", a->table,
                      "the picture of the board on the table, instead of the first: a file, or its "
                      "name in the folder");
  command->add_option("--only", a->only, "intrinsics, or place (with the lens as configured)")
      ->check(CLI::IsMember({"intrinsics", "place"}));
  command->add_option("--views", a->views, "views taken from a running camera")
      ->check(CLI::Range(5, 200))
      ->capture_default_str();
  command->add_option("--limit", a->limit, "s after which a running camera is given up")
      ->check(CLI::Range(1.0, 1e6))
      ->capture_default_str();
  command->add_option("--worst", a->worst, "px, residual above which the answer is no")
      ->check(CLI::Range(0.01, 100.0))
      ->capture_default_str();
  command->add_flag("--write", a->write, "write the keys into the configuration file");
  command->add_flag("--json", a->json, "print the outcome as one JSON document");
  program.on(*command, [a] { return calibrate_with(*a); });
}

}  // namespace prehend::recognition
