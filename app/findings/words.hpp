#pragma once
/// Small words of sentences made from counts.
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace perp::app::comparison {

/// "a", "a and b", "a, b and c", "a, b, c and 4 others".
std::string listed(const std::vector<std::string>& names);
/// "1 pair", "3 pairs"; `several` for those whose plural is not with an s.
std::string counted(std::size_t count, std::string_view one, std::string_view several = {});
/// "x solves", "x and y solve".
std::string verb(std::size_t subjects, std::string_view infinitive);
std::string is(std::size_t subjects);
/// "24 of 25 (96 %)": one digit more, and never 100 % or 0 % unless it is that.
std::string share_words(std::size_t count, std::size_t of);
std::string percent(std::size_t count, std::size_t of);

}  // namespace perp::app::comparison
