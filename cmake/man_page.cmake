# The man page with the program's own lists of methods and options:
#   cmake -DPERP=PROGRAM -DSOURCE=perp.1 -DRESULT=FILE -P man_page.cmake
execute_process(COMMAND ${PERP} -AMPL -= OUTPUT_VARIABLE options COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCH "^method +([^\n]*)" first "${options}")
set(methods "${CMAKE_MATCH_1}")
string(REGEX REPLACE "([^ \n]+) +([^\n]*)\n +([^\n]*)\n" ".It Cm \\1\n\\2\n.br\n\\3\n" options "${options}")
configure_file(${SOURCE} ${RESULT} @ONLY)
