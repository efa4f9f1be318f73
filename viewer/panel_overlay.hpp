// Private to panel.cpp and panel_overlay.cpp. Boxes are left, top, right, bottom of the screen, in its points.
#ifndef NEPH_PANEL_OVERLAY_HPP
#define NEPH_PANEL_OVERLAY_HPP

#include "panel.h"

#include <imgui.h>

constexpr float panel_plain_width = 310; // of the panel, where a letter is as wide as it is by itself
float panel_width();

// Where the window that is being drawn stands.
ImVec4 panel_window_box();

// The picture itself, the difference, wires, and the line of a split one.
void panel_draw_picture(const view_panel_input &in, const ImVec2 &screen);
// Keys and mouse; where the help stands.
ImVec4 panel_draw_help(const ImVec2 &screen);
// What takes long (in.work, not NULL), how far it is, and a way to end it; above the notes. Where it stands.
ImVec4 panel_draw_work(const view_panel_input &in, view_panel_wish &wish, const ImVec2 &screen);
// Status, errors and what was said, at the lower edge.
void panel_draw_notes(const view_panel_input &in, const ImVec2 &screen);

#endif
