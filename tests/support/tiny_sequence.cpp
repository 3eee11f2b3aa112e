// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/tiny_sequence.h"

#include <fstream>
#include <string>

namespace fabloop::testing_support {

namespace fs = std::filesystem;

SyntheticFlightOptions tiny_sequence_options() {
  SyntheticFlightOptions options;
  options.seed = 3;
  options.camera = scaled(synthetic_camera(), 0.375);
  options.flight.length_m = 100;
  options.flight.spacing_m = 4;
  options.flight.mean_height_m = 20;
  options.flight.height_spread_m = 2;
  options.meadow.texture_m_per_px = 0.08;
  options.meadow.height_m_per_px = 0.2;
  options.effects.p_soft = 0;
  options.drift.rotation_noise_deg = 1;
  options.drift.heading_drift_deg_per_100m = 20;
  return options;
}

void make_tiny_sequence() {
  write_synthetic_flight(FABLOOP_TINY_SEQUENCE_DIR, tiny_sequence_options(), OutputFolder::IfExists::Replace);
}

fs::path tiny_sequence() {
  const fs::path folder = FABLOOP_TINY_SEQUENCE_DIR;
  if (!fs::exists(folder)) make_tiny_sequence();
  return folder;
}

void copy_tiny_sequence(const fs::path& folder, std::size_t num_frames) {
  fs::create_directories(folder / "images");
  fs::copy(tiny_sequence(), folder);
  std::ifstream all(tiny_sequence() / "frames.csv");
  std::ofstream first(folder / "frames.csv");
  for (std::string line; num_frames > 0 && std::getline(all, line);) {
    first << line << '\n';
    if (line.starts_with('#')) continue;
    const std::string image = line.substr(0, line.find(','));
    fs::copy(tiny_sequence() / "images" / image, folder / "images" / image);
    --num_frames;
  }
}

}  // namespace fabloop::testing_support
