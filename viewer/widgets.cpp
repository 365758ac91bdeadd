/* Dear ImGui behind a C header; see widgets.h. The only C++ of the viewer. */
#include "viewer/widgets.h"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>

#include "viewer/chart.h"

static double scale_of_all = 1;
static const viewer_colours *colours = viewer_colours_of(VIEWER_DARK);

/* ---- letters: of a family that was drawn for screens, or what most systems have ---- */

static bool has_letters;
static ImFont *plain, *strong, *small; // all the same where there is no family
static const char *const families[][2] = {
    {"/usr/share/fonts/opentype/inter/Inter-Regular.otf", "/usr/share/fonts/opentype/inter/Inter-SemiBold.otf"},
    {"/usr/share/fonts/inter/Inter-Regular.otf", "/usr/share/fonts/inter/Inter-SemiBold.otf"},
    {"/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf", "/usr/share/fonts/truetype/noto/NotoSans-Bold.ttf"},
    {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf", "/usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf"},
    {"/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf",
     "/usr/share/fonts/truetype/liberation/LiberationSans-Bold.ttf"},
    {"/usr/share/fonts/TTF/DejaVuSans.ttf", "/usr/share/fonts/TTF/DejaVuSans-Bold.ttf"},
    {"/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf", "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans-Bold.ttf"},
};

static bool is_there(const char *path) {
    FILE *file = std::fopen(path, "rb");
    if (file) std::fclose(file);
    return file != nullptr;
}

static bool take_letters(double scale) {
    // Latin, Greek, punctuation, raised and lowered numbers, arrows and signs of formulas
    static const ImWchar glyphs[] = {0x20,   0x17f,  0x370,  0x3ff,  0x2000, 0x209f, 0x2190, 0x21ff,
                                     0x2200, 0x22ff, 0x25a0, 0x25ff, 0};
    ImGuiIO &io = ImGui::GetIO();
    for (const char *const *family : families) {
        if (!is_there(family[0])) continue;
        const float size = std::round(static_cast<float>(14 * scale));
        plain = io.Fonts->AddFontFromFileTTF(family[0], size, nullptr, glyphs);
        if (!plain) continue;
        small = io.Fonts->AddFontFromFileTTF(family[0], std::round(static_cast<float>(12 * scale)), nullptr, glyphs);
        strong = is_there(family[1]) ? io.Fonts->AddFontFromFileTTF(family[1], size, nullptr, glyphs) : plain;
        if (!strong) strong = plain;
        if (!small) small = plain;
        return true;
    }
    plain = strong = small = io.Fonts->AddFontDefault();
    io.FontGlobalScale = static_cast<float>(scale);
    return false;
}

/* ---- the theme ---- */

static ImVec4 paint(uint32_t colour, float opacity = 1) {
    const float part = 1.0f / 255;
    return ImVec4(part * static_cast<float>(colour >> 16 & 255), part * static_cast<float>(colour >> 8 & 255),
                  part * static_cast<float>(colour & 255), opacity);
}

static ImU32 ink(uint32_t colour, float opacity = 1) {
    return ImGui::ColorConvertFloat4ToU32(paint(colour, opacity));
}

static void lay_out(ImGuiStyle &style) {
    style.WindowRounding = 8;
    style.ChildRounding = 8;
    style.PopupRounding = 6;
    style.FrameRounding = 5;
    style.GrabRounding = 4;
    style.ScrollbarRounding = 6;
    style.TabRounding = 5;
    style.WindowPadding = ImVec2(10, 8);
    style.FramePadding = ImVec2(7, 2);
    style.ItemSpacing = ImVec2(6, 4);
    style.ItemInnerSpacing = ImVec2(7, 4);
    style.IndentSpacing = 12;
    style.ScrollbarSize = 11;
    style.GrabMinSize = 8;
    style.WindowTitleAlign = ImVec2(0, 0.5f);
    style.ScaleAllSizes(static_cast<float>(scale_of_all));
    style.WindowBorderSize = style.PopupBorderSize = 1; // a line is a line on any screen
}

void widgets_theme(const viewer_colours *theme) {
    static const ImVec4 none(0, 0, 0, 0);
    colours = theme;
    ImGui::GetStyle() = ImGuiStyle();
    ImGuiStyle &style = ImGui::GetStyle();
    if (theme == viewer_colours_of(VIEWER_LIGHT)) ImGui::StyleColorsLight();
    else ImGui::StyleColorsDark();
    lay_out(style);
    const struct {
        ImGuiCol_ what;
        ImVec4 colour;
    } paints[] = {
        {ImGuiCol_Text, paint(theme->text)},
        {ImGuiCol_TextDisabled, paint(theme->quiet)},
        {ImGuiCol_WindowBg, paint(theme->panel)},
        {ImGuiCol_PopupBg, paint(theme->raised)},
        {ImGuiCol_Border, paint(theme->line)},
        {ImGuiCol_FrameBg, paint(theme->field)},
        {ImGuiCol_FrameBgHovered, paint(theme->field_over)},
        {ImGuiCol_FrameBgActive, paint(theme->field_over)},
        {ImGuiCol_TitleBg, paint(theme->panel)},
        {ImGuiCol_TitleBgActive, paint(theme->panel)},
        {ImGuiCol_TitleBgCollapsed, paint(theme->panel)},
        {ImGuiCol_ScrollbarBg, none},
        {ImGuiCol_ScrollbarGrab, paint(theme->field_over)},
        {ImGuiCol_ScrollbarGrabHovered, paint(theme->knob)},
        {ImGuiCol_ScrollbarGrabActive, paint(theme->knob)},
        {ImGuiCol_CheckMark, paint(theme->accent)},
        // a slider's knob lies under its number, which is read through it
        {ImGuiCol_SliderGrab, paint(theme->knob, static_cast<float>(VIEWER_KNOB_OPACITY))},
        {ImGuiCol_SliderGrabActive, paint(theme->accent, static_cast<float>(VIEWER_HELD_OPACITY))},
        {ImGuiCol_Button, paint(theme->field)},
        {ImGuiCol_ButtonHovered, paint(theme->field_over)},
        {ImGuiCol_ButtonActive, paint(theme->accent, 0.6f)},
        {ImGuiCol_Header, paint(theme->raised)},
        {ImGuiCol_HeaderHovered, paint(theme->field)},
        {ImGuiCol_HeaderActive, paint(theme->field_over)},
        {ImGuiCol_Separator, paint(theme->line)},
        {ImGuiCol_ResizeGrip, none},
        {ImGuiCol_ResizeGripHovered, paint(theme->knob)},
        {ImGuiCol_ResizeGripActive, paint(theme->accent)},
        {ImGuiCol_TextSelectedBg, paint(theme->accent, 0.35f)},
        {ImGuiCol_NavHighlight, paint(theme->accent)},
    };
    for (const auto &p : paints) style.Colors[p.what] = p.colour;
}

bool widgets_open(struct GLFWwindow *window, double scale, const viewer_colours *theme) {
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGuiIO &io = ImGui::GetIO();
    io.IniFilename = nullptr; // nothing is left behind in the working directory
    io.ConfigWindowsMoveFromTitleBarOnly = true;
    scale_of_all = scale;
    has_letters = take_letters(scale);
    widgets_theme(theme);
    return ImGui_ImplGlfw_InitForOpenGL(reinterpret_cast<GLFWwindow *>(window), true) &&
           ImGui_ImplOpenGL3_Init("#version 450 core");
}

bool widgets_has_letters(void) {
    return has_letters;
}

void widgets_close(void) {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
}

void widgets_begin(void) {
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
}

void widgets_end(void) {
    ImGui::Render();
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

bool widgets_want_pointer(void) {
    return ImGui::GetIO().WantCaptureMouse;
}

bool widgets_want_keys(void) {
    return ImGui::GetIO().WantTextInput;
}

double widgets_scale(void) {
    return scale_of_all;
}

double widgets_line(void) {
    return ImGui::GetFrameHeightWithSpacing();
}

// ---- panels

bool widgets_panel(const char *title, widgets_frame frame, double x, double y, double width, double height,
                   bool *open) {
    ImGuiCond when = frame == WIDGETS_FREE ? ImGuiCond_Appearing : ImGuiCond_Always;
    ImGuiWindowFlags flags = ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNavInputs;
    if (frame != WIDGETS_FREE)
        flags |= ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoBringToFrontOnFocus |
                 ImGuiWindowFlags_NoCollapse;
    if (frame == WIDGETS_FIXED) flags |= ImGuiWindowFlags_NoTitleBar;
    if (frame == WIDGETS_DOCKED) flags |= ImGuiWindowFlags_HorizontalScrollbar;
    ImGui::SetNextWindowPos(ImVec2(static_cast<float>(x), static_cast<float>(y)), when);
    ImGui::SetNextWindowSize(ImVec2(static_cast<float>(width), static_cast<float>(height)), when);
    // what fills its part of the window has no round corners
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, frame == WIDGETS_FREE ? ImGui::GetStyle().WindowRounding : 0);
    bool unfolded = ImGui::Begin(title, frame == WIDGETS_FIXED ? nullptr : open, flags);
    ImGui::PopStyleVar();
    return unfolded;
}

void widgets_note(const char *text, double x, double y, bool above, double width, bool warning, double box[4]) {
    // before all panels, so that nothing hides an error
    ImDrawList *list = ImGui::GetForegroundDrawList();
    const ImVec2 pad = ImGui::GetStyle().WindowPadding;
    const float bar = warning ? static_cast<float>(4 * scale_of_all) : 0;
    const float room = static_cast<float>(width) - 2 * pad.x - bar;
    const ImVec2 size = ImGui::CalcTextSize(text, nullptr, false, room);
    const float left = static_cast<float>(x), high = size.y + 1.4f * pad.y;
    const float top = static_cast<float>(y) - (above ? high : 0);
    const ImVec2 from(left, top), to(left + size.x + 2 * pad.x + bar, top + high);
    list->AddRectFilled(from, to, ink(colours->panel, 0.95f), 6);
    list->AddRect(from, to, ink(warning ? colours->warning : colours->line), 6);
    if (warning) list->AddRectFilled(from, ImVec2(left + bar, to.y), ink(colours->warning), 6, ImDrawFlags_RoundCornersLeft);
    list->AddText(plain, ImGui::GetFontSize(), ImVec2(left + pad.x + bar, top + 0.7f * pad.y), ink(colours->text), text,
                  nullptr, room);
    box[0] = from.x, box[1] = from.y, box[2] = to.x - from.x, box[3] = to.y - from.y;
}

bool widgets_over(const char *id, double x, double y, double left, double right) {
    // half of it may not pass an edge: its width is known from the frame before
    static float width = 0;
    float half = 0.5f * width + 4, least = static_cast<float>(left) + half, most = static_cast<float>(right) - half;
    float at = most > least ? std::clamp(static_cast<float>(x), least, most) : static_cast<float>(0.5 * (left + right));
    ImGui::SetNextWindowPos(ImVec2(at, static_cast<float>(y)), ImGuiCond_Always, ImVec2(0.5f, 1.0f));
    ImGui::SetNextWindowSizeConstraints(ImVec2(0, 0), ImVec2(static_cast<float>(right - left) - 8, FLT_MAX));
    ImGui::Begin(id, nullptr,
                 ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNavInputs | ImGuiWindowFlags_NoDecoration |
                     ImGuiWindowFlags_NoMove | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoFocusOnAppearing |
                     ImGuiWindowFlags_NoBringToFrontOnFocus);
    width = ImGui::GetWindowWidth();
    return !ImGui::IsWindowAppearing();
}

void widgets_panel_end(void) {
    ImGui::End();
}

bool widgets_group(const char *title, bool open) {
    ImGui::PushFont(strong);
    bool unfolded = ImGui::CollapsingHeader(title, open ? ImGuiTreeNodeFlags_DefaultOpen : 0);
    ImGui::PopFont();
    return unfolded;
}

bool widgets_tree(const char *title, bool open) {
    return ImGui::TreeNodeEx(title, open ? ImGuiTreeNodeFlags_DefaultOpen : 0);
}

void widgets_tree_end(void) {
    ImGui::TreePop();
}

void widgets_push(const void *id) {
    ImGui::PushID(id);
}

void widgets_pop(void) {
    ImGui::PopID();
}

// ---- controls

void widgets_text(const char *text) {
    ImGui::TextUnformatted(text);
}

void widgets_heading(const char *text) {
    ImGui::PushFont(strong);
    ImGui::TextUnformatted(text);
    ImGui::PopFont();
}

void widgets_quiet(const char *text) {
    ImGui::PushStyleColor(ImGuiCol_Text, paint(colours->quiet));
    ImGui::PushTextWrapPos(0);
    ImGui::TextUnformatted(text);
    ImGui::PopTextWrapPos();
    ImGui::PopStyleColor();
}

void widgets_wrapped(const char *text, bool warning) {
    if (warning) ImGui::PushStyleColor(ImGuiCol_Text, paint(colours->warning));
    ImGui::PushTextWrapPos(0);
    ImGui::TextUnformatted(text);
    ImGui::PopTextWrapPos();
    if (warning) ImGui::PopStyleColor();
}

void widgets_marked(const char *line, size_t first, size_t count) {
    const size_t length = std::strlen(line), from = std::min(first ? first - 1 : 0, length), to = std::min(from + count, length);
    ImVec2 at = ImGui::GetCursorScreenPos();
    ImGui::TextUnformatted(line);
    const float high = ImGui::GetTextLineHeight(), mark = 0.35f * high;
    const float left = at.x + ImGui::CalcTextSize(line, line + from).x, right = at.x + ImGui::CalcTextSize(line, line + to).x;
    const float end = std::max(right, left + 0.4f * high), middle = 0.5f * (left + end);
    ImDrawList *list = ImGui::GetWindowDrawList();
    const ImU32 colour = ink(colours->warning);
    list->AddLine(ImVec2(left, at.y + high + 1), ImVec2(end, at.y + high + 1), colour, 2);
    list->AddTriangleFilled(ImVec2(middle - mark, at.y + high + 2 + mark), ImVec2(middle, at.y + high + 2),
                            ImVec2(middle + mark, at.y + high + 2 + mark), colour);
    ImGui::Dummy(ImVec2(end - at.x, mark + 2));
}

void widgets_same_line(void) {
    ImGui::SameLine();
}

void widgets_new_line(void) {
    ImGui::NewLine();
}

void widgets_gap(void) {
    ImGui::Spacing();
}

void widgets_line_across(void) {
    ImGui::Separator();
}

bool widgets_button(const char *title) {
    return ImGui::Button(title);
}

bool widgets_main_button(const char *title) {
    ImGui::PushStyleColor(ImGuiCol_Button, paint(colours->accent));
    ImGui::PushStyleColor(ImGuiCol_ButtonHovered, paint(colours->accent_over));
    ImGui::PushStyleColor(ImGuiCol_ButtonActive, paint(colours->accent_over));
    ImGui::PushStyleColor(ImGuiCol_Text, paint(colours->on_accent));
    // as wide for one word as for the other, so that what follows stays where it is
    bool pressed = ImGui::Button(title, ImVec2(ImGui::GetFontSize() * 4.2f, 0));
    ImGui::PopStyleColor(4);
    return pressed;
}

bool widgets_tick(const char *title, bool *value) {
    return ImGui::Checkbox(title, value);
}

/* The box of the control that is made next, without its title. */
static double frame[4];

static void note_frame() {
    ImVec2 at = ImGui::GetCursorScreenPos();
    float width = ImGui::GetContentRegionAvail().x * 0.55f;
    ImGui::SetNextItemWidth(width);
    frame[0] = at.x, frame[1] = at.y, frame[2] = width, frame[3] = ImGui::GetFrameHeight();
}

/* Rows of the list that is unfolded. */
static double rows[64][4];
static int row_count;

bool widgets_choice(const char *title, const char *words, int *place) {
    char word[128];
    bool chosen = false;
    int row = 0;
    auto next = [&](const char *from) {
        size_t length = std::strcspn(from, "|");
        std::snprintf(word, sizeof word, "%.*s", static_cast<int>(length), from);
        return from[length] ? from + length + 1 : nullptr;
    };
    word[0] = 0;
    for (const char *at = words; at && row <= *place; row++) at = next(at);
    if (*place < 0 || row <= *place) word[0] = 0;
    note_frame();
    row_count = 0;
    if (!ImGui::BeginCombo(title, word, ImGuiComboFlags_HeightLarge)) return false;
    row = 0;
    for (const char *at = words; at; row++) {
        at = next(at);
        ImGui::PushID(row);
        if (ImGui::Selectable(word, row == *place)) *place = row, chosen = true;
        ImGui::PopID();
        // in its first picture the list is not yet where it will be
        if (row < 64 && !ImGui::IsWindowAppearing()) widgets_last(rows[row]), row_count = row + 1;
    }
    ImGui::EndCombo();
    return chosen;
}

bool widgets_choice_row(int row, double rectangle[4]) {
    if (row >= row_count) return false;
    std::memcpy(rectangle, rows[row], sizeof rows[row]);
    return true;
}

void widgets_last_frame(double rectangle[4]) {
    std::memcpy(rectangle, frame, sizeof frame);
}

bool widgets_numbers(const char *title, double *numbers, int count, double least, double most, bool logarithmic,
                     bool whole, const char *format) {
    ImGuiSliderFlags flags = (logarithmic ? ImGuiSliderFlags_Logarithmic : 0) | ImGuiSliderFlags_NoRoundToFormat;
    note_frame();
    if (!whole) return ImGui::SliderScalarN(title, ImGuiDataType_Double, numbers, count, &least, &most, format, flags);
    int given[4], low = static_cast<int>(least), high = static_cast<int>(most);
    for (int i = 0; i < count; i++) given[i] = static_cast<int>(numbers[i]);
    bool changed = ImGui::SliderScalarN(title, ImGuiDataType_S32, given, count, &low, &high, "%d", flags);
    for (int i = 0; i < count; i++) numbers[i] = given[i];
    return changed;
}

bool widgets_begun(void) {
    return ImGui::IsItemActivated();
}

bool widgets_released(void) {
    return ImGui::IsItemDeactivatedAfterEdit();
}

bool widgets_typing(void) {
    return ImGui::IsItemActive() && ImGui::GetIO().WantTextInput;
}

bool widgets_input(const char *title, char *text, size_t size) {
    note_frame();
    return ImGui::InputText(title, text, size, ImGuiInputTextFlags_EnterReturnsTrue);
}

bool widgets_input_fitting(const char *title, char *text, size_t size) {
    float least = ImGui::GetFontSize() * 16, wide = ImGui::CalcTextSize(text).x + ImGui::GetFontSize() * 2;
    ImGui::SetNextItemWidth(std::min(std::max(wide, least), ImGui::GetIO().DisplaySize.x * 0.6f));
    return ImGui::InputText(title, text, size, ImGuiInputTextFlags_EnterReturnsTrue);
}

bool widgets_input_lines(const char *title, char *text, size_t size) {
    float lines = 2;
    for (const char *c = text; *c; c++) lines += *c == '\n';
    if (lines > 12) lines = 12;
    note_frame();
    ImVec2 room(ImGui::GetContentRegionAvail().x * 0.55f, ImGui::GetTextLineHeight() * (lines + 0.5f));
    return ImGui::InputTextMultiline(title, text, size, room,
                                     ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_CtrlEnterForNewLine);
}

void widgets_help(const char *text) {
    if (!ImGui::IsItemHovered()) return;
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(ImGui::GetFontSize() * 24);
    ImGui::TextUnformatted(text);
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
}

bool widgets_menu(const char *title) {
    return ImGui::BeginPopupContextItem(title);
}

bool widgets_menu_row(const char *title) {
    return ImGui::MenuItem(title);
}

void widgets_menu_end(void) {
    ImGui::EndPopup();
}

// ---- over the picture

void widgets_over_picture(const double box[4]) {
    const ImVec2 from(static_cast<float>(box[0]), static_cast<float>(box[1]));
    ImGui::GetBackgroundDrawList()->PushClipRect(
        from, ImVec2(from.x + static_cast<float>(box[2]), from.y + static_cast<float>(box[3])));
}

void widgets_over_picture_end(void) {
    ImGui::GetBackgroundDrawList()->PopClipRect();
}

static const float edge_opacity = 0.45f;

void widgets_stroke(const float from[2], const float to[2], float width, uint32_t colour, float opacity) {
    ImDrawList *list = ImGui::GetBackgroundDrawList();
    const ImVec2 a(from[0], from[1]), b(to[0], to[1]);
    if (width >= 2) list->AddLine(a, b, ink(0x000000, edge_opacity * opacity), width + 2);
    list->AddLine(a, b, ink(colour, opacity), width);
}

void widgets_fill(float (*corners)[2], int count, uint32_t colour, float opacity) {
    ImVec2 at[4];
    for (int i = 0; i < count && i < 4; i++) at[i] = ImVec2(corners[i][0], corners[i][1]);
    ImDrawList *list = ImGui::GetBackgroundDrawList();
    // edges are smoothed only where corners go round one way
    if (count == 3) list->AddTriangleFilled(at[0], at[1], at[2], ink(colour, opacity));
    else list->AddQuadFilled(at[0], at[1], at[2], at[3], ink(colour, opacity));
}

void widgets_circle(const float middle[2], float radius, float width, uint32_t colour, float opacity) {
    ImDrawList *list = ImGui::GetBackgroundDrawList();
    const ImVec2 at(middle[0], middle[1]);
    if (width > 0) list->AddCircle(at, radius, ink(0x000000, edge_opacity * opacity), 0, width + 1.5f);
    else list->AddCircleFilled(at, radius + 1.2f, ink(0x000000, edge_opacity * opacity));
    if (width > 0) list->AddCircle(at, radius, ink(colour, opacity), 0, width);
    else list->AddCircleFilled(at, radius, ink(colour, opacity));
}

// ---- plots and pictures

/* The step of 1, 2 or 5 times a power of ten that divides a span into at most so many. */
static float step_of(float span, float most) {
    float about = span / std::max(most, 1.0f), power = std::pow(10.0f, std::floor(std::log10(about)));
    float times = about / power;
    return power * (times <= 1.001f ? 1 : times <= 2.001f ? 2 : times <= 5.001f ? 5 : 10.0f);
}

static void write_tick(char *text, size_t size, float value, float step) {
    if (std::fabs(value) < 1e-4f * step) value = 0;
    bool whole = step >= 1 && std::fabs(value) < 1e5f;
    int digits = std::min(std::max(static_cast<int>(std::ceil(-std::log10(step) - 1e-3f)), 0), 6);
    if (std::fabs(value) >= 1e5f || (step < 1e-4f && value != 0)) std::snprintf(text, size, "%.3g", static_cast<double>(value));
    else std::snprintf(text, size, "%.*f", whole ? 0 : digits, static_cast<double>(value));
}

/* Title and, after it, the names of the curves in their colours; as far as there is room. */
static void write_legend(const widgets_chart *chart, ImVec2 at, float width) {
    ImDrawList *list = ImGui::GetWindowDrawList();
    list->PushClipRect(at, ImVec2(at.x + width, at.y + 3 * ImGui::GetFontSize()), true);
    list->AddText(strong, strong->FontSize, at, ink(colours->text), chart->title);
    float x = at.x, y = at.y + strong->FontSize + 2, size = small->FontSize, all = 0;
    for (int s = 0; s < chart->series_count; s++)
        if (chart->series[s] && chart->names[s] && chart->names[s][0])
            all += small->CalcTextSizeA(size, FLT_MAX, 0, chart->names[s]).x + 1.6f * size;
    if (all > width) size *= std::max(width / all, 0.7f); // names that have no room are written smaller
    for (int s = 0; s < chart->series_count; s++) {
        if (!chart->series[s] || !chart->names[s] || !chart->names[s][0]) continue;
        float wide = small->CalcTextSizeA(size, FLT_MAX, 0, chart->names[s]).x;
        list->AddRectFilled(ImVec2(x, y + 0.42f * size), ImVec2(x + 0.7f * size, y + 0.62f * size),
                            ink(colours->series[s % VIEWER_SERIES]));
        list->AddText(small, size, ImVec2(x + 0.9f * size, y), ink(colours->quiet), chart->names[s]);
        x += wide + 1.6f * size;
    }
    list->PopClipRect();
}

/* Where a chart's curves are, and what its axes span. */
struct frame_of_chart {
    ImVec2 from, to;
    float least, most, begin, end;
    float x(float time) const { return from.x + (to.x - from.x) * (time - begin) / (end - begin); }
    float y(float value) const { return to.y - (to.y - from.y) * (value - least) / (most - least); }
};

static void draw_axes(const frame_of_chart &f, float line) {
    ImDrawList *list = ImGui::GetWindowDrawList();
    char text[32];
    list->AddRectFilled(f.from, f.to, ink(colours->chart), 3);
    float step = step_of(f.most - f.least, (f.to.y - f.from.y) / (1.6f * line));
    for (float v = std::ceil(f.least / step - 1e-3f) * step; v <= f.most + 1e-3f * step; v += step) {
        write_tick(text, sizeof text, v, step);
        float y = f.y(v), wide = small->CalcTextSizeA(line, FLT_MAX, 0, text).x;
        list->AddLine(ImVec2(f.from.x, y), ImVec2(f.to.x, y), ink(colours->line));
        list->AddText(small, line, ImVec2(f.from.x - wide - 4, y - 0.5f * line), ink(colours->quiet), text);
    }
    step = step_of(f.end - f.begin, (f.to.x - f.from.x) / (3.2f * line));
    for (float t = std::ceil(f.begin / step - 1e-3f) * step; t <= f.end + 1e-3f * step; t += step) {
        write_tick(text, sizeof text - 3, t, step);
        float x = f.x(t);
        if (t + step > f.end + 1e-3f * step) std::strcat(text, " s"); // the unit, once
        float wide = small->CalcTextSizeA(line, FLT_MAX, 0, text).x;
        list->AddLine(ImVec2(x, f.to.y), ImVec2(x, f.to.y + 3), ink(colours->quiet));
        list->AddText(small, line, ImVec2(std::min(x - 0.5f * wide, f.to.x - 0.7f * wide), f.to.y + 3), ink(colours->quiet), text);
    }
}

static void draw_curves(const widgets_chart *chart, const frame_of_chart &f) {
    ImDrawList *list = ImGui::GetWindowDrawList();
    list->PushClipRect(f.from, f.to, true);
    for (int s = 0; s < chart->series_count; s++) {
        const float *values = chart->series[s];
        for (size_t i = 0; values && i + 1 < chart->count; i++) {
            size_t here = (chart->first + i) % chart->room, next = (here + 1) % chart->room;
            if (!std::isfinite(values[here]) || !std::isfinite(values[next])) continue;
            list->AddLine(ImVec2(f.x(chart->times[here]), f.y(values[here])),
                          ImVec2(f.x(chart->times[next]), f.y(values[next])), ink(colours->series[s % VIEWER_SERIES]), 1.6f);
        }
    }
    list->PopClipRect();
}

void widgets_chart_show(const widgets_chart *chart, double width, double height) {
    frame_of_chart f;
    viewer_chart_range(chart->series, chart->series_count, chart->first, chart->count, chart->room, chart->compared,
                       &f.least, &f.most);
    // a little air above and below; what is never negative stands on its axis
    float air = 0.06f * (f.most - f.least);
    f.least = f.least >= 0 && f.least <= air * 4 ? 0 : f.least - air, f.most += air;
    f.begin = chart->count ? chart->times[chart->first] : 0;
    f.end = chart->count ? chart->times[(chart->first + chart->count - 1) % chart->room] : 0;
    f.end = std::max(f.end, f.begin + 1); // a new plot does not start with one wide step
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float line = small->FontSize, wide = static_cast<float>(width), high = static_cast<float>(height);
    f.from = ImVec2(at.x + 3.2f * line, at.y + strong->FontSize + line + 8);
    f.to = ImVec2(at.x + wide - 4, at.y + high - line - 5);
    if (f.to.y > f.from.y + 8 && f.to.x > f.from.x + 8) {
        draw_axes(f, line);
        draw_curves(chart, f);
    }
    write_legend(chart, at, wide);
    ImGui::Dummy(ImVec2(wide, high));
}

bool widgets_picture(unsigned texture, double width, double height) {
    ImVec2 size(static_cast<float>(width), static_cast<float>(height));
    if (!texture) return ImGui::Button("...", size);
    ImTextureID id = reinterpret_cast<ImTextureID>(static_cast<intptr_t>(texture));
    return ImGui::ImageButton(id, size, ImVec2(0, 0), ImVec2(1, 1), 0);
}

void widgets_columns(int count) {
    ImGui::Columns(count, nullptr, false);
}

void widgets_next_column(void) {
    ImGui::NextColumn();
}

bool widgets_list(const char *id, double width, double height) {
    if (ImGui::BeginChild(id, ImVec2(static_cast<float>(width), static_cast<float>(height)))) return true;
    ImGui::EndChild();
    return false;
}

void widgets_list_end(void) {
    ImGui::EndChild();
}

double widgets_height(void) {
    return std::max(ImGui::GetContentRegionAvail().y, 1.0f);
}

double widgets_room(void) {
    return ImGui::GetContentRegionAvail().x;
}

void widgets_last(double rectangle[4]) {
    ImVec2 least = ImGui::GetItemRectMin(), size = ImGui::GetItemRectSize();
    rectangle[0] = least.x, rectangle[1] = least.y, rectangle[2] = size.x, rectangle[3] = size.y;
}

bool widgets_last_visible(void) {
    return ImGui::IsItemVisible();
}

void widgets_follow(void) {
    if (ImGui::GetScrollY() >= ImGui::GetScrollMaxY() - 1) ImGui::SetScrollHereY(1.0f);
}
