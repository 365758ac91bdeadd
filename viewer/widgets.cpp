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

static double scale_of_all = 1;

/* Letters that most systems have; without any of them the built-in ones are scaled. */
static const char *const letters[] = {
    "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
    "/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf",
    "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf",
    "/usr/share/fonts/TTF/DejaVuSans.ttf",
    "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
};

static void take_letters(double scale) {
    ImGuiIO &io = ImGui::GetIO();
    for (const char *path : letters) {
        FILE *file = std::fopen(path, "rb");
        if (!file) continue;
        std::fclose(file);
        if (io.Fonts->AddFontFromFileTTF(path, static_cast<float>(13 * scale))) return;
    }
    io.FontGlobalScale = static_cast<float>(scale);
}

bool widgets_open(struct GLFWwindow *window, double scale) {
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGuiIO &io = ImGui::GetIO();
    io.IniFilename = nullptr; // nothing is left behind in the working directory
    io.ConfigWindowsMoveFromTitleBarOnly = true;
    scale_of_all = scale;
    take_letters(scale);
    ImGui::StyleColorsDark();
    ImGuiStyle &style = ImGui::GetStyle();
    style.WindowRounding = 4;
    style.FrameRounding = 3;
    style.GrabRounding = 3;
    style.WindowPadding = ImVec2(6, 6);
    style.FramePadding = ImVec2(4, 2);
    style.ItemSpacing = ImVec2(5, 3);
    style.IndentSpacing = 10;
    style.ScrollbarSize = 11;
    style.Colors[ImGuiCol_WindowBg].w = 0.90f;
    // a slider's knob lies over its number: dark, so that the number is read through it
    style.Colors[ImGuiCol_SliderGrab] = ImVec4(0.24f, 0.42f, 0.66f, 0.75f);
    style.Colors[ImGuiCol_SliderGrabActive] = ImVec4(0.26f, 0.50f, 0.80f, 0.85f);
    style.GrabMinSize = 7;
    style.ScaleAllSizes(static_cast<float>(scale));
    return ImGui_ImplGlfw_InitForOpenGL(reinterpret_cast<GLFWwindow *>(window), true) &&
           ImGui_ImplOpenGL3_Init("#version 450 core");
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
    if (frame == WIDGETS_FIXED)
        flags |= ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoTitleBar |
                 ImGuiWindowFlags_NoBringToFrontOnFocus;
    ImGui::SetNextWindowPos(ImVec2(static_cast<float>(x), static_cast<float>(y)), when);
    ImGui::SetNextWindowSize(ImVec2(static_cast<float>(width), static_cast<float>(height)), when);
    return ImGui::Begin(title, frame == WIDGETS_FREE ? open : nullptr, flags);
}

void widgets_note(const char *id, const char *text, double x, double y, bool above, double width) {
    ImGui::SetNextWindowPos(ImVec2(static_cast<float>(x), static_cast<float>(y)), ImGuiCond_Always,
                            ImVec2(0, above ? 1.0f : 0.0f));
    ImGuiWindowFlags flags = ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNavInputs |
                             ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs |
                             ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoFocusOnAppearing;
    if (ImGui::Begin(id, nullptr, flags)) {
        // as wide as the text, and at most as wide as there is room
        float most = static_cast<float>(width) - 2 * ImGui::GetStyle().WindowPadding.x;
        ImVec2 size = ImGui::CalcTextSize(text);
        ImGui::PushTextWrapPos(ImGui::GetCursorPosX() + (size.x < most ? size.x + 1 : most));
        ImGui::TextUnformatted(text);
        ImGui::PopTextWrapPos();
    }
    ImGui::End();
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
    return ImGui::CollapsingHeader(title, open ? ImGuiTreeNodeFlags_DefaultOpen : 0);
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

void widgets_wrapped(const char *text, bool warning) {
    if (warning) ImGui::PushStyleColor(ImGuiCol_Text, ImVec4(1, 0.72f, 0.35f, 1));
    ImGui::PushTextWrapPos(0);
    ImGui::TextUnformatted(text);
    ImGui::PopTextWrapPos();
    if (warning) ImGui::PopStyleColor();
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

// ---- plots and pictures

static const ImU32 colours[] = {IM_COL32(110, 190, 255, 255), IM_COL32(255, 170, 80, 255), IM_COL32(150, 220, 120, 255),
                                IM_COL32(235, 235, 235, 255)};

/* What an axis spans: all finite values. Where two things are compared, those of the calmer one with as much again and
 * ten times that: what blows up leaves the picture at its edge, and what it is compared with stays to be seen. */
static void find_range(const float *const *series, int series_count, size_t first, size_t count, size_t room,
                       bool compared, float *least, float *most) {
    float all_least = FLT_MAX, all_most = -FLT_MAX, calm = FLT_MAX, low = 0, high = 0;
    for (int s = 0; s < series_count; s++) {
        float from = FLT_MAX, to = -FLT_MAX;
        for (size_t i = 0; series[s] && i < count; i++) {
            float value = series[s][(first + i) % room];
            if (!std::isfinite(value)) continue;
            from = std::min(from, value), to = std::max(to, value);
        }
        if (from > to) continue;
        all_least = std::min(all_least, from), all_most = std::max(all_most, to);
        float reach = std::max(to - from, 0.1f * std::max(std::fabs(from), std::fabs(to)));
        if (reach < calm) calm = reach, low = from, high = to;
    }
    *least = all_least <= all_most ? all_least : 0, *most = all_least <= all_most ? all_most : 0;
    if (compared && calm > 0 && calm < FLT_MAX) {
        *most = std::min(*most, high + 10 * calm);
        *least = std::max(*least, low - 10 * calm);
    }
    if (*most - *least < 1e-6f) *least -= 0.5f, *most += 0.5f;
}

void widgets_plot(const char *title, const float *const *series, const char *const *names, int series_count,
                  size_t first, size_t count, size_t room, bool compared, double height) {
    float least = 0, most = 0;
    find_range(series, series_count, first, count, room, compared, &least, &most);
    ImVec2 at = ImGui::GetCursorScreenPos(), size(ImGui::GetContentRegionAvail().x, static_cast<float>(height));
    ImDrawList *list = ImGui::GetWindowDrawList();
    list->AddRectFilled(at, ImVec2(at.x + size.x, at.y + size.y), IM_COL32(20, 22, 26, 200), 3);
    float span = static_cast<float>(count > 60 ? count - 1 : 59); // a new plot does not start with one wide step
    list->PushClipRect(at, ImVec2(at.x + size.x, at.y + size.y), true);
    for (int s = 0; s < series_count; s++) {
        if (!series[s] || count < 2) continue;
        for (size_t i = 0; i + 1 < count; i++) {
            float a = series[s][(first + i) % room], b = series[s][(first + i + 1) % room];
            if (!std::isfinite(a) || !std::isfinite(b)) continue;
            float x = at.x + size.x * static_cast<float>(i) / span,
                  next = at.x + size.x * static_cast<float>(i + 1) / span;
            list->AddLine(ImVec2(x, at.y + size.y * (1 - (a - least) / (most - least))),
                          ImVec2(next, at.y + size.y * (1 - (b - least) / (most - least))), colours[s % 4], 1.5f);
        }
    }
    list->PopClipRect();
    char range[64];
    std::snprintf(range, sizeof range, "%.4g", static_cast<double>(most));
    list->AddText(ImVec2(at.x + 3, at.y + 1), IM_COL32(200, 200, 200, 190), range);
    std::snprintf(range, sizeof range, "%.4g", static_cast<double>(least));
    list->AddText(ImVec2(at.x + 3, at.y + size.y - ImGui::GetFontSize() - 1), IM_COL32(200, 200, 200, 190), range);
    ImGui::Dummy(size);
    ImGui::TextUnformatted(title);
    for (int s = 0; s < series_count; s++) {
        if (!series[s] || !names[s]) continue;
        ImGui::SameLine();
        ImGui::PushStyleColor(ImGuiCol_Text, colours[s % 4]);
        ImGui::TextUnformatted(names[s]);
        ImGui::PopStyleColor();
    }
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
