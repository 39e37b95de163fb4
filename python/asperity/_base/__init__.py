"""What every room stands on: checks of arguments, frozen values, files, tables, reports."""
