#include <stdexcept>

#include "contact_peers.hpp"

namespace perp::bench {

std::vector<std::string> contact_peers() { return {}; }

PeerRun run_contact_peer(const std::string& name, const contact::Problem&, double) {
  throw std::invalid_argument(name + ": built without Siconos");
}

}  // namespace perp::bench
