#ifndef PLANEFOLD_CALIBRATE_PRINT_TARGET_H
#define PLANEFOLD_CALIBRATE_PRINT_TARGET_H

#include <string>

#include "board.h"

namespace pf::calibrate {

/// page  a4, a3, letter, or WIDTHxHEIGHT in millimetres, 50 to 5000; false: it is none of these
bool page_size(const std::string& page, double& width_mm, double& height_mm);

/// Writes the board as a PDF of true size, with a line of 100 mm to check the printer by; a path that ends in .png
/// becomes a picture of ten pixels per millimetre.
/// page  as page_size has it; it is turned if the board fits better
/// false: error is one line
bool print_target(const Board& board, const std::string& page, const std::string& path, std::string& error);

}  // namespace pf::calibrate

#endif
