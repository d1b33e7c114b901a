# Prints the comments of a source that state a copyright, for packages that have it compiled in.
/^\/\*/ { comment = ""; inside = 1 }
inside { comment = comment $0 "\n" }
/\*\// { if (inside && comment ~ /Copyright/) print comment; inside = 0 }
