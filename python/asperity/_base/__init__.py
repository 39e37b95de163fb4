"""Common to all subpackages: checks of arguments, frozen values, files, tables, reports."""
