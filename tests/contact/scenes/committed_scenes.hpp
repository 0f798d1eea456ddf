// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The generated problems kept in data/contact, NAME.hdf5 each: what make_scenes writes and committed_scenes_test
/// reads.
#include <filesystem>
#include <vector>

#include "contact/scenes/generators.hpp"

namespace perp::contact {

inline std::vector<Scene> committed_scenes() {
  std::vector<Scene> scenes;
  scenes.push_back(make_scene(BoxStack{.boxes = 5}));
  scenes.push_back(make_scene(Spheres{.spheres = 15, .mu = 0.4}));
  scenes.push_back(make_scene(Arch{.voussoirs = 9}));
  scenes.push_back(make_scene(Arch{.voussoirs = 13, .thickness = 0.12}));  // too thin by half
  scenes.back().name += "-falling";
  scenes.push_back(make_scene(Chain{.links = 10, .points = 2}));
  scenes.push_back(make_scene(Wall{.courses = 3, .bricks = 3}));
  scenes.push_back(make_scene(Incline{.boxes = 4, .angle = 0.46}));  // stays: atan(0.5) = 0.4636
  scenes.push_back(make_scene(Incline{.boxes = 3, .angle = 0.47}));
  scenes.back().name += "-sliding";
  return scenes;
}

inline std::filesystem::path committed_file(const std::filesystem::path& folder, const Scene& scene) {
  return folder / (scene.name + ".hdf5");
}

}  // namespace perp::contact
