"""Equations of motion linearised about steady sliding, eigenvalues, causes of growth."""
