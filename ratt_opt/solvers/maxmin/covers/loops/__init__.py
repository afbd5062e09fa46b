"""The compiled loops of the search by covers.

``tables`` : the arrays that they share; ``team`` : what groups are worth; ``keeping`` : what an attack can leave;
``attacking``, ``forbidding``, ``leaving``, ``diving`` : the search in depth
"""
