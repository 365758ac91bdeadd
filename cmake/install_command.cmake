# What `cmake --install` brings of the command: itself, its modules, its scenes and their meshes.
install(TARGETS skein)
if(TARGET skein_film_module)
    install(TARGETS skein_film_module DESTINATION ${CMAKE_INSTALL_LIBDIR}/skein)
endif()
if(TARGET skein_ranks_module)
    install(TARGETS skein_ranks_module DESTINATION ${CMAKE_INSTALL_LIBDIR}/skein)
endif()
if(TARGET skein_fit_module)
    install(TARGETS skein_fit_module DESTINATION ${CMAKE_INSTALL_LIBDIR}/skein)
endif()
install(DIRECTORY scenes/ DESTINATION ${CMAKE_INSTALL_DATADIR}/skein/scenes
    FILES_MATCHING PATTERN "*.json" PATTERN elephant.json EXCLUDE PATTERN statue.json EXCLUDE)
install(DIRECTORY meshes/ DESTINATION ${CMAKE_INSTALL_DATADIR}/skein/meshes)
# The meshes of these are fetched, by `make demo`: they come along where that was done.
foreach(pair elephant:elephant statue:man)
    string(REPLACE ":" ";" pair ${pair})
    list(GET pair 0 scene)
    list(GET pair 1 mesh)
    install(CODE "
        if(EXISTS \"${PROJECT_SOURCE_DIR}/meshes/fetched/${mesh}.off\")
            file(INSTALL \"${PROJECT_SOURCE_DIR}/scenes/${scene}.json\" DESTINATION \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DATADIR}/skein/scenes\")
        endif()")
endforeach()
