# Writes the header that the catalogue reads its kinds from: an extern for each, and a list for each category.
#     cmake -DOUTPUT=catalogue_kinds.h "-DFILES=a.c;b.c" -P kinds.cmake
# A kind is a line `const sk_force_type sk_gravity = {` of its file. The header changes only when the list does.

cmake_minimum_required(VERSION 3.25)

# In which order they are shown; those that have no place here follow, by their files' names.
set(order
    cloth lattice rope tetrahedra flock
    distance dihedral isometric straight twist area volume angle attachment formula_constraint energy enclosed_volume pressure
    gravity wind surface_wind drag separation flocking attraction predator lookout speed_limit turn_limit bounds
    force_field potential surface_contact
    plane sphere bowl capsule box solid_mesh sampled_field formula_surface
    translate turn keys cache attach
    explicit_euler symplectic_euler lookahead_euler midpoint leapfrog rk4 backward_euler xpbd pbd)

set(text "/* Made by cmake/kinds.cmake; do not edit. */\n#ifndef SK_CATALOGUE_KINDS_H\n#define SK_CATALOGUE_KINDS_H\n")
set(categories body constraint force collider motion method)
list(SORT FILES)
foreach(category IN LISTS categories)
    set(found_${category} "")
endforeach()
foreach(file IN LISTS FILES)
    file(STRINGS "${file}" lines REGEX "^const sk_[a-z]+_type sk_[a-z0-9_]+ = ")
    foreach(line IN LISTS lines)
        string(REGEX MATCH "^const sk_([a-z]+)_type sk_([a-z0-9_]+) = " line "${line}")
        if(CMAKE_MATCH_1 IN_LIST categories)
            list(APPEND found_${CMAKE_MATCH_1} ${CMAKE_MATCH_2})
        endif()
    endforeach()
endforeach()
foreach(category IN LISTS categories)
    set(sorted "")
    foreach(kind IN LISTS order found_${category})
        if(kind IN_LIST found_${category} AND NOT kind IN_LIST sorted)
            list(APPEND sorted ${kind})
        endif()
    endforeach()
    if(NOT sorted)
        message(FATAL_ERROR "no ${category} was found in the files of kinds")
    endif()
    list(TRANSFORM sorted PREPEND "sk_")
    list(JOIN sorted ", " externs)
    list(TRANSFORM sorted PREPEND "&")
    list(JOIN sorted ", " addresses)
    string(TOUPPER ${category} word)
    string(APPEND text "\nextern const sk_${category}_type ${externs};\n#define SK_${word}_KINDS ${addresses}\n")
endforeach()
string(APPEND text "\n#endif\n")

set(old "")
if(EXISTS "${OUTPUT}")
    file(READ "${OUTPUT}" old)
endif()
if(NOT old STREQUAL text)
    file(WRITE "${OUTPUT}" "${text}")
endif()
