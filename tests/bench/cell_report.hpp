#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "cell_runs.hpp"
#include "graspd/formats/table.hpp"

namespace graspd::bench {

struct BinResult {
  BinKey key;
  BinRow bin;
  std::vector<PickRow> picks;
};

/// The two files that grow while the bench runs, a row for each pick and for each bin. A bin
/// without its own row was not emptied to the end: its picks are forgotten.
class CellLog {
 public:
  /// \param stem of the files' names. \throws std::runtime_error where they can't be written.
  CellLog(const std::string& stem, bool fresh);

  bool has(const BinKey& key) const;
  void add(const BinKey& key, const PickRow& pick);
  void add(const BinKey& key, const BinRow& bin);
  const std::vector<BinResult>& results() const { return results_; }

 private:
  void read();
  void rewrite();
  BinResult& at(const BinKey& key);

  std::filesystem::path picks_path_, bins_path_;
  std::vector<BinResult> results_;
  std::vector<BinKey> done_;
};

/// A row for each part and pipeline, with 95 % intervals (Wilson).
Table cell_table(const std::vector<BinResult>& results);
/// part → pipeline → figure
nlohmann::json cell_figures(const std::vector<BinResult>& results);

}  // namespace graspd::bench
