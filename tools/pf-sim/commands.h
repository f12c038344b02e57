#pragma once

#include <CLI/CLI.hpp>
#include <string>

/// One function per command: adds it to the program; when it is chosen it runs and sets the exit code.
namespace pfsim {

void add_render(CLI::App& app, int& result);
void add_room(CLI::App& app, int& result);
void add_gee2007(CLI::App& app, int& result);
void add_rendered(CLI::App& app, int& result);
void add_kidnap(CLI::App& app, int& result);
void add_rest(CLI::App& app, int& result);
void add_box(CLI::App& app, int& result);
void add_loop(CLI::App& app, int& result);
void add_street(CLI::App& app, int& result);
void add_vio(CLI::App& app, int& result);
void add_templates(CLI::App& app, int& result);

/// What to say of a scene that is none: its name, and those that there are.
std::string no_scene(const std::string& scene);

}  // namespace pfsim
