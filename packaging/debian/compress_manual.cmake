# Run by CPack on the files of the packages: Debian has manual pages compressed, without a date.
find_program(find find REQUIRED)
find_program(gzip gzip REQUIRED)
execute_process(
  COMMAND ${find} ${CPACK_TEMPORARY_INSTALL_DIRECTORY} -path */share/man/man?/* -type f
          -exec ${gzip} -9n {} +
  COMMAND_ERROR_IS_FATAL ANY)
