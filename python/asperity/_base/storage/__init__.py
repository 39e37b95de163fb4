"""What stands on disk: values as data, TOML, archives of arrays, complete files and folders."""
