# Of Skein's sources those that make skein.wasm, as `skein_js_sources`: what reads scenes and their meshes, the tables as JSON,
# the view's fields and the hand that pulls. tests/test_page.c is linked from the same, so that each build misses what is
# missing here.
set(skein_js_sources bindings/js/exports.c bindings/js/files.c app/list_json.c render/view.c viewer/grab.c)
file(GLOB readers CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/io/*_read.c
    ${PROJECT_SOURCE_DIR}/io/mesh*.c ${PROJECT_SOURCE_DIR}/io/scene*.c)
list(FILTER readers EXCLUDE REGEX "/scene_source[.]c$") # which looks into folders
list(APPEND skein_js_sources ${readers})
foreach(name advice budget cache clip clip_obj errors groups obj_write pc2 ply_write printable reach stl_write uncut weld)
    list(APPEND skein_js_sources io/${name}.c)
endforeach()
list(TRANSFORM skein_js_sources PREPEND ${PROJECT_SOURCE_DIR}/)
