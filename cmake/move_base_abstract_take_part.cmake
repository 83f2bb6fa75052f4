# move_base_abstract_take_part(TARGET)
#
# Make a roscpp program take part in lockstep, however it is started: docs/lockstep_cpp.md. The library must be the first
# one of the program, so it stands before the program's own files in the linker's command line, whatever else is linked.
function(move_base_abstract_take_part target)
  set(library move_base_abstract_roscpp_shim)
  if(TARGET ${library})  # in a build of several packages at once
    add_dependencies(${target} ${library})
    set(path $<TARGET_FILE:${library}>)
    set(folder $<TARGET_FILE_DIR:${library}>)
  else()
    get_filename_component(folder ${move_base_abstract_DIR}/../../../lib ABSOLUTE)
    set(path ${folder}/lib${library}.so)
  endif()
  target_link_options(${target} PRIVATE LINKER:--push-state,--no-as-needed ${path} LINKER:--pop-state)
  set_property(TARGET ${target} APPEND PROPERTY BUILD_RPATH ${folder})
endfunction()
