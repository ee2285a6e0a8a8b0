#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "services/recorder/core/dataset/rows.hpp"

namespace prehend::recorder::dataset {

/// Writes an HDF5 file. Names are paths (/data/demo_0/obs/state); groups on the way are made. The
/// first failure is what close() says; what comes after one does nothing.
class Hdf5File {
 public:
  static Expected<Hdf5File> create(const std::filesystem::path& path);
  Hdf5File(Hdf5File&&) noexcept;
  Hdf5File& operator=(Hdf5File&&) noexcept;
  ~Hdf5File();

  enum class Precision { single, twofold };
  void write(const std::string& name, const Table& values, Precision precision);
  /// One dimension.
  void write(const std::string& name, const Eigen::VectorXd& values, Precision precision);
  /// As bytes of one length, which is how h5py writes a list of names.
  void write(const std::string& name, const std::vector<std::string>& texts);

  /// Bytes of any shape, written row by row (the first dimension); each row is a chunk of its own,
  /// compressed (deflate) where it is asked for.
  void begin_bytes(const std::string& name, const std::vector<std::size_t>& shape, bool compressed);
  void add_bytes(const std::vector<std::uint8_t>& row);
  void end_bytes();

  void attribute(const std::string& group, const std::string& name, std::int64_t value);
  void attribute(const std::string& group, const std::string& name, const std::string& value);
  void attribute(const std::string& group, const std::string& name, const Eigen::VectorXd& value);
  /// As h5py reads and writes truth: an enumeration of FALSE and TRUE.
  void attribute(const std::string& group, const std::string& name, bool value);
  void attribute(const std::string& group, const std::string& name, const char* value) = delete;

  Expected<void> close();

 private:
  struct State;
  explicit Hdf5File(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace prehend::recorder::dataset
