#!/usr/bin/python3
import figures

figures.main("Any two columns against each other, and the points that no other point dominates.", "pareto")
