#include "services/recorder/tools/dataset/hdf5_file.hpp"

#include <hdf5.h>

#include <algorithm>
#include <utility>

namespace prehend::recorder::dataset {
namespace {

/// Owner of one of the library's handles, each kind with its own way to close it.
class Handle {
 public:
  Handle(hid_t id, herr_t (*how)(hid_t)) : id_(id), close_(how) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const { return id_; }
  bool close() { return id_ < 0 || close_(std::exchange(id_, -1)) >= 0; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

constexpr unsigned deflate_level = 4;

Handle space_of(const std::vector<hsize_t>& shape) {
  return {H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose};
}
Handle scalar() {
  return {H5Screate(H5S_SCALAR), H5Sclose};
}

/// Text of any length.
Handle text_type() {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, H5T_VARIABLE);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return type;
}

Handle truth_type() {
  Handle type(H5Tenum_create(H5T_NATIVE_INT8), H5Tclose);
  for (const signed char value : {0, 1})
    H5Tenum_insert(type, value == 0 ? "FALSE" : "TRUE", &value);
  return type;
}

}  // namespace

struct Hdf5File::State {
  std::string name;
  Handle file{-1, H5Fclose};
  Handle rows{-1, H5Dclose};  // dataset of bytes that is being written
  std::vector<hsize_t> shape;
  hsize_t next = 0;
  bool failed = false;

  void check(bool good) { failed = failed || !good; }

  Handle create(const std::string& dataset, hid_t type, const std::vector<hsize_t>& dimensions,
                hid_t how) {
    const Handle groups(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
    H5Pset_create_intermediate_group(groups, 1);
    const Handle space = space_of(dimensions);
    Handle made(H5Dcreate2(file, dataset.c_str(), type, space, groups, how, H5P_DEFAULT), H5Dclose);
    check(made >= 0);
    return made;
  }

  void numbers(const std::string& dataset, const std::vector<hsize_t>& dimensions,
               const double* values, Precision precision) {
    if (failed) return;
    const hid_t type = precision == Precision::single ? H5T_IEEE_F32LE : H5T_IEEE_F64LE;
    const Handle made = create(dataset, type, dimensions, H5P_DEFAULT);
    if (std::ranges::find(dimensions, 0u) != dimensions.end()) return;  // nothing to write
    check(made >= 0 &&
          H5Dwrite(made, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
  }

  void attribute(const std::string& group, const std::string& key, hid_t type, const Handle& space,
                 const void* value) {
    if (failed) return;
    const Handle made(H5Acreate_by_name(file, group.c_str(), key.c_str(), type, space, H5P_DEFAULT,
                                        H5P_DEFAULT, H5P_DEFAULT),
                      H5Aclose);
    check(made >= 0 && H5Awrite(made, type, value) >= 0);
  }
};

Expected<Hdf5File> Hdf5File::create(const std::filesystem::path& path) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // what goes wrong is said by our errors
  auto state = std::make_unique<State>();
  state->name = path.string();
  state->file = Handle(H5Fcreate(path.c_str(), H5F_ACC_EXCL, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
  if (state->file < 0) return fail("cannot be written", path.string(), "is the folder writable?");
  return Hdf5File(std::move(state));
}

Hdf5File::Hdf5File(std::unique_ptr<State> state) : state_(std::move(state)) {}
Hdf5File::Hdf5File(Hdf5File&&) noexcept = default;
Hdf5File& Hdf5File::operator=(Hdf5File&&) noexcept = default;
Hdf5File::~Hdf5File() = default;

void Hdf5File::write(const std::string& name, const Table& values, Precision precision) {
  state_->numbers(name, {static_cast<hsize_t>(values.rows()), static_cast<hsize_t>(values.cols())},
                  values.data(), precision);
}

void Hdf5File::write(const std::string& name, const Eigen::VectorXd& values, Precision precision) {
  state_->numbers(name, {static_cast<hsize_t>(values.size())}, values.data(), precision);
}

void Hdf5File::write(const std::string& name, const std::vector<std::string>& texts) {
  if (state_->failed) return;
  std::size_t length = 1;
  for (const std::string& text : texts) length = std::max(length, text.size());
  std::string all;
  for (const std::string& text : texts) (all += text).append(length - text.size(), '\0');
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, length);
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  const Handle made = state_->create(name, type, {texts.size()}, H5P_DEFAULT);
  state_->check(made >= 0 && H5Dwrite(made, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data()) >= 0);
}

void Hdf5File::begin_bytes(const std::string& name, const std::vector<std::size_t>& shape,
                           bool compressed) {
  if (state_->failed) return;
  state_->shape.assign(shape.begin(), shape.end());
  state_->next = 0;
  std::vector<hsize_t> chunk = state_->shape;
  chunk.front() = 1;
  const Handle how(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_chunk(how, static_cast<int>(chunk.size()), chunk.data());
  if (compressed) H5Pset_deflate(how, deflate_level);
  state_->rows = state_->create(name, H5T_STD_U8LE, state_->shape, how);
}

void Hdf5File::add_bytes(const std::vector<std::uint8_t>& row) {
  State& state = *state_;
  if (state.failed) return;
  std::vector<hsize_t> from(state.shape.size(), 0), extent = state.shape;
  from.front() = state.next++;
  extent.front() = 1;
  hsize_t size = 1;
  for (const hsize_t each : extent) size *= each;
  const Handle memory = space_of(extent), place(H5Dget_space(state.rows), H5Sclose);
  state.check(size == row.size() &&
              H5Sselect_hyperslab(place, H5S_SELECT_SET, from.data(), nullptr, extent.data(),
                                  nullptr) >= 0 &&
              H5Dwrite(state.rows, H5T_NATIVE_UINT8, memory, place, H5P_DEFAULT, row.data()) >= 0);
}

void Hdf5File::end_bytes() {
  state_->check(state_->rows.close());
}

void Hdf5File::attribute(const std::string& group, const std::string& name, std::int64_t value) {
  state_->attribute(group, name, H5T_NATIVE_INT64, scalar(), &value);
}

void Hdf5File::attribute(const std::string& group, const std::string& name,
                         const std::string& value) {
  const char* text = value.c_str();
  state_->attribute(group, name, text_type(), scalar(), &text);
}

void Hdf5File::attribute(const std::string& group, const std::string& name,
                         const Eigen::VectorXd& value) {
  state_->attribute(group, name, H5T_NATIVE_DOUBLE, space_of({static_cast<hsize_t>(value.size())}),
                    value.data());
}

void Hdf5File::attribute(const std::string& group, const std::string& name, bool value) {
  const signed char byte = value ? 1 : 0;
  state_->attribute(group, name, truth_type(), scalar(), &byte);
}

Expected<void> Hdf5File::close() {
  State& state = *state_;
  state.check(state.rows.close());
  state.check(state.file.close());
  if (state.failed) return fail("cannot be written", state.name, "is the disk full?");
  return {};
}

}  // namespace prehend::recorder::dataset
