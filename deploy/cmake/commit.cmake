# Writes into FILE which commit SOURCE is, with «-dirty» where something was changed since. There is
# no file where SOURCE is no clone.
execute_process(
  COMMAND git -C ${SOURCE} describe --always --dirty --abbrev=12 --exclude=*
  OUTPUT_VARIABLE commit ERROR_QUIET RESULT_VARIABLE failed)
if(failed)
  file(REMOVE ${FILE})
  return()
endif()
set(old "")
if(EXISTS ${FILE})
  file(READ ${FILE} old)
endif()
if(NOT old STREQUAL commit)
  file(WRITE ${FILE} "${commit}")
endif()
