# Writes OUTPUT, a C++ file with one string_view for each "name=file" of INPUTS; files of the same name are joined.
# cmake -D OUTPUT=page.cpp -D INPUTS=kStyle=page.css,kScript=a.js,kScript=b.js -P embed.cmake

string(REPLACE "," ";" inputs "${INPUTS}")
set(names)
foreach(input IN LISTS inputs)
    string(REGEX MATCH "^([^=]+)=(.+)$" matched "${input}")
    set(name ${CMAKE_MATCH_1})
    file(READ "${CMAKE_MATCH_2}" bytes HEX)
    string(APPEND bytes_of_${name} "${bytes}")
    list(APPEND names ${name})
endforeach()
list(REMOVE_DUPLICATES names)

set(code "#include \"experiments/report/page.h\"\n\nnamespace ulam::page {\n")
foreach(name IN LISTS names)
    string(REGEX REPLACE "(..)" "\\\\x\\1" escaped "${bytes_of_${name}}")
    # One line per 8 bytes: the compiler joins the pieces of a literal.
    string(REGEX REPLACE "((\\\\x..)(\\\\x..)(\\\\x..)(\\\\x..)(\\\\x..)(\\\\x..)(\\\\x..)(\\\\x..))" "\\1\"\n\"" escaped "${escaped}")
    string(LENGTH "${bytes_of_${name}}" digits)
    math(EXPR size "${digits} / 2")
    string(APPEND code "const std::string_view ${name}(\n\"${escaped}\", ${size});\n")
endforeach()
string(APPEND code "}  // namespace ulam::page\n")
file(WRITE "${OUTPUT}" "${code}")
