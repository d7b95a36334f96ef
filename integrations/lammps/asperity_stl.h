// Triangles of an STL file, binary or ASCII. Under the GNU General Public License, version 2, as the files that include it.
#ifndef ASPERITY_STL_H
#define ASPERITY_STL_H

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <locale>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace LAMMPS_NS {

using Corners = std::array<std::array<double, 3>, 3>;

class Stl {
  static constexpr uint64_t MOST = 10000000, HEAD = 84, FACET = 50;    // facets; bytes of a binary file
  static constexpr double FARTHEST = 1e30;
  std::string text;

  [[noreturn]] static void wrong(const std::string &what) { throw std::runtime_error(what); }

  static std::string lower(std::string word)
  {
    for (char &c : word)
      if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return word;
  }

  void read_text(const std::string &file)
  {
    std::ifstream in(file, std::ios::binary | std::ios::ate);
    const auto size = in ? static_cast<int64_t>(in.tellg()) : -1;
    // Of a folder some systems tell a size that no file has.
    if (size < 0 || size == INT64_MAX) wrong("cannot be opened");
    if (static_cast<uint64_t>(size) > HEAD + FACET * MOST * 6) wrong("is larger than any file of 10 million facets");
    text.resize(static_cast<size_t>(size));
    in.seekg(0);
    if (size == 0) wrong("is empty");
    if (!in.read(&text[0], size)) wrong("cannot be read");
  }

  uint64_t told_facets() const
  {
    uint32_t count = 0;
    for (int k = 3; k >= 0; k--) count = count << 8 | static_cast<unsigned char>(text[80 + k]);
    return count;
  }

  void add(std::vector<Corners> &out, Corners corners, double scale) const
  {
    const std::string who = "facet " + std::to_string(out.size() + 1);
    for (auto &corner : corners)
      for (double &v : corner) {
        v *= scale;
        if (!(std::abs(v) < FARTHEST)) wrong(who + " has a corner that is no place");
      }
    double longest = 0.0, e[3][3];
    for (int k = 0; k < 3; k++) {
      double size = 0.0;
      for (int d = 0; d < 3; d++) {
        e[k][d] = corners[(k + 1) % 3][d] - corners[k][d];
        size += e[k][d] * e[k][d];
      }
      longest = std::max(longest, size);
    }
    const double cross[3] = {e[0][1] * e[1][2] - e[0][2] * e[1][1], e[0][2] * e[1][0] - e[0][0] * e[1][2],
                             e[0][0] * e[1][1] - e[0][1] * e[1][0]};
    const double area = std::sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]);
    // Below that the direction of its normal is rounding.
    if (!(area > 1e-9 * longest))
      wrong(who + " is degenerate: its corners are on one line. Mend the file, or leave that facet out");
    out.push_back(corners);
    if (out.size() > MOST) wrong("has more than 10 million facets");
  }

  void read_binary(std::vector<Corners> &out, double scale) const
  {
    const uint64_t count = told_facets();
    out.reserve(count);
    for (uint64_t f = 0; f < count; f++) {
      const char *at = text.data() + HEAD + FACET * f + 12;    // behind its normal
      Corners corners;
      for (auto &corner : corners)
        for (double &v : corner) {
          uint32_t bits = 0;
          for (int k = 3; k >= 0; k--) bits = bits << 8 | static_cast<unsigned char>(at[k]);
          float number;
          memcpy(&number, &bits, sizeof number);
          v = number;
          at += 4;
        }
      add(out, corners, scale);
    }
  }

  void read_ascii(std::vector<Corners> &out, double scale) const
  {
    std::istringstream in(text);
    in.imbue(std::locale::classic());
    std::string word, line;
    const auto who = [&] { return "ends or is damaged within facet " + std::to_string(out.size() + 1); };
    const auto expect = [&](const char *wanted) {
      if (!(in >> word) || lower(word) != wanted) wrong(who());
    };
    bool open = false;
    while (in >> word) {
      word = lower(word);
      if (word == "solid" || word == "endsolid") {
        if (open == (word == "solid")) wrong(who());
        open = word == "solid";
        std::getline(in, line);    // its name
      } else if (word == "facet" && open) {
        expect("normal");
        for (int k = 0; k < 3; k++)
          if (!(in >> word)) wrong(who());    // of no use: the corners tell it
        expect("outer");
        expect("loop");
        Corners corners;
        for (auto &corner : corners) {
          expect("vertex");
          for (double &v : corner) {
            if (!(in >> word)) wrong(who());
            std::istringstream number(word);
            number.imbue(std::locale::classic());
            if (!(number >> v) || !number.eof())
              wrong("facet " + std::to_string(out.size() + 1) + " has a corner that is no place: " + word.substr(0, 40));
          }
        }
        expect("endloop");
        expect("endfacet");
        add(out, corners, scale);
      } else {
        wrong(who());
      }
    }
    if (open) wrong(who());
  }

 public:
  // Reads a file. Throws std::runtime_error with what is wrong with it.
  static std::vector<Corners> read(const std::string &file, double scale)
  {
    Stl stl;
    stl.read_text(file);
    const std::string &text = stl.text;
    const uint64_t size = text.size(), count = size >= HEAD ? stl.told_facets() : 0;
    const bool starts = lower(text.substr(0, 5)) == "solid";
    const bool has_zeros = memchr(text.data(), 0, std::min<uint64_t>(size, 1024)) != nullptr;
    std::vector<Corners> out;
    if (size >= HEAD && size == HEAD + FACET * count) {
      if (count > MOST) wrong("has " + std::to_string(count) + " facets, and 10 million are the most");
      stl.read_binary(out, scale);
    } else if (starts && !has_zeros) {
      stl.read_ascii(out, scale);
    } else if (size >= HEAD) {
      wrong("is damaged: its head tells of " + std::to_string(count) + " facets, which take " +
            std::to_string(HEAD + FACET * count) + " bytes, and it has " + std::to_string(size));
    } else {
      wrong("is no STL file: it is too short for one");
    }
    if (out.empty()) wrong("has no facets");
    return out;
  }
};

}    // namespace LAMMPS_NS

#endif
