"""From files to a law with figures and tables: what the commands of identification do."""
