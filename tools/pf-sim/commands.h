#pragma once

#include <CLI/CLI.hpp>

/// One function per command: adds it to the program; when it is chosen it runs and sets the exit code.
namespace pfsim {

void add_render(CLI::App& app, int& result);
void add_room(CLI::App& app, int& result);
void add_gee2007(CLI::App& app, int& result);
void add_rendered(CLI::App& app, int& result);

}  // namespace pfsim
